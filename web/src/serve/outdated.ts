// Whether the server was started anew since the page was loaded: the page's token is of the earlier one, and all that it sends is rejected.
import { useEffect, useState } from 'preact/hooks';

let outdated = false;
const listeners = new Set<() => void>();

export function sayOutdated(): void {
  outdated = true;
  for (const listener of listeners) listener();
}

export function isOutdated(): boolean {
  return outdated;
}

export function useOutdated(): boolean {
  const [known, setKnown] = useState(outdated);
  useEffect(() => {
    const listener = () => setKnown(true);
    listeners.add(listener);
    if (outdated) listener();
    return () => void listeners.delete(listener);
  }, []);
  return known;
}
