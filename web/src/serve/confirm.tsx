// A question before what cannot be undone, in the page.
import type { ComponentChildren } from 'preact';
import { useEffect, useLayoutEffect, useRef, useState } from 'preact/hooks';
import { Button, Panel } from './pieces';

/** The focus, where it was lost: to what had it before, else to the view's heading. */
export function focusBack(before: Element | null): void {
  if (document.activeElement !== null && document.activeElement !== document.body) return;
  if (before instanceof HTMLElement && before.isConnected && before !== document.body && !before.matches(':disabled')) before.focus();
  else document.querySelector<HTMLElement>('#view h1')?.focus({ preventScroll: true });
}

export interface Asked<T> {
  what: T | null; // null: nothing is asked
  times: number; // the key of the question: asked once more it takes the focus again, as after a double click
}

export function useAsked<T>(): [Asked<T>, (what: T | null) => void] {
  const [asked, setAsked] = useState<Asked<T>>({ what: null, times: 0 });
  return [asked, (what) => setAsked(({ times }) => ({ what, times: times + 1 }))];
}

interface ConfirmProps {
  heading: string;
  yes: string; // what is done
  no: string;
  act: () => void;
  cancel: () => void;
  children: ComponentChildren; // what would be lost
}

/** Its safe answer has the focus, and is also Escape. */
export function Confirm({ heading, yes, no, act, cancel, children }: ConfirmProps) {
  const root = useRef<HTMLDivElement>(null);
  useLayoutEffect(() => {
    const before = document.activeElement;
    root.current!.querySelector('button')!.focus();
    return () => void requestAnimationFrame(() => focusBack(before));
  }, []);
  const left = useRef(cancel);
  left.current = cancel;
  useEffect(() => {
    const press = ({ key }: KeyboardEvent) => key === 'Escape' && left.current();
    document.addEventListener('keydown', press);
    return () => document.removeEventListener('keydown', press);
  }, []);
  return (
    <Panel heading={heading} name="confirm">
      <div ref={root}>
        <p>{children}</p>
        <div class="buttons">
          <Button act={cancel}>{no}</Button>
          <Button main act={act}>
            {yes}
          </Button>
        </div>
      </div>
    </Panel>
  );
}
