// What someone who cannot see the spindles is told of them.
import type { MonitorState } from '../../documents';
import { dash, modeName } from '../../text';
import type { MonitorFrame } from './documents';
import { chatterText, stateText } from './text';

/** Of a state that is not the one before; null: nothing. */
export function newsText(name: string, before: MonitorState | undefined, now: MonitorFrame): string | null {
  if (now.state === 'chatter') {
    const more = [chatterText(now), modeName(now)].filter((text) => text !== '' && text !== dash);
    return `${name}: chatter${more.length > 0 ? ` at ${more.join(', ')}` : ''}`;
  }
  return before === undefined ? null : `${name}: ${stateText(now)}`;
}

interface Waiting {
  chatter: string | null;
  after: string | null; // what came of it, or another state
}

/** Changes of state that are still to be told. Chatter comes first and is lost to nothing that follows it; else the newest of each spindle counts. */
export class News {
  private readonly states = new Map<number, MonitorState>(); // the last one, but for transitions: to chatter and back is no news
  private readonly waiting = new Map<number, Waiting>();

  take(id: number, name: string, frame: MonitorFrame): void {
    const before = this.states.get(id);
    if (frame.state === 'transition' || frame.state === before) return;
    this.states.set(id, frame.state);
    const text = newsText(name, before, frame);
    if (text === null) return;
    const waits = this.waiting.get(id);
    this.waiting.set(id, frame.state === 'chatter' ? { chatter: text, after: null } : { chatter: waits?.chatter ?? null, after: text });
  }

  forget(id: number): void {
    this.states.delete(id);
    this.waiting.delete(id);
  }

  /** What is told next; null: nothing. */
  next(): string | null {
    const all = [...this.waiting];
    const [id, waits] = all.find(([, { chatter }]) => chatter !== null) ?? all[0] ?? [];
    if (id === undefined || waits === undefined) return null;
    if (waits.chatter !== null && waits.after !== null) this.waiting.set(id, { chatter: null, after: waits.after });
    else this.waiting.delete(id);
    return waits.chatter ?? waits.after;
  }
}
