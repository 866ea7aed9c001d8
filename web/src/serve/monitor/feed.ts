// What the server says of monitored spindles, for the view that is open; nothing is kept for one that is not.
import type { MonitorMessage } from './documents';

type Listener<T> = (value: T) => void;

class Calls<T> {
  private readonly listeners = new Set<Listener<T>>();
  readonly say = (value: T) => {
    for (const listener of this.listeners) listener(value);
  };
  /** Until the function that it gives is called. */
  readonly listen = (listener: Listener<T>) => {
    this.listeners.add(listener);
    return () => void this.listeners.delete(listener);
  };
}

export class MonitorFeed {
  readonly messages = new Calls<MonitorMessage>();
  readonly changes = new Calls<void>(); // a session began, runs, has ended or is gone: ask for the list
  readonly reconnected = new Calls<void>(); // what was said before that is lost
}

export const monitorFeed = new MonitorFeed();
