// Which view is shown: the address behind the #.
import { useEffect, useState } from 'preact/hooks';

export const views = ['overview', 'files', 'jobs', 'job', 'program', 'lobes', 'tap', 'monitor'] as const;
export type View = (typeof views)[number];

export interface Route {
  view: View;
  path: string; // of a file, the number of a job, or empty
}

/** "#/lobes/a/lobes.toml"; anything else is the overview. */
export function parseRoute(hash: string): Route {
  const [, name = '', path = ''] = /^#\/(\w+)(?:\/(.*))?$/s.exec(hash) ?? [];
  const view = views.find((known) => known === name);
  if (!view) return { view: 'overview', path: '' };
  return { view, path: path.split('/').map(decoded).join('/') };
}

function decoded(part: string): string {
  try {
    return decodeURIComponent(part);
  } catch {
    return part; // a % of its own
  }
}

export function href(view: View, path = ''): string {
  return `#/${view}${path === '' ? '' : `/${path.split('/').map(encodeURIComponent).join('/')}`}`;
}

export function goTo(view: View, path = ''): void {
  window.location.hash = href(view, path);
}

/** The route now and whenever it changes. A link to a place in the page (without a slash) is none. */
export function useRoute(): Route {
  const [route, setRoute] = useState(() => parseRoute(window.location.hash));
  useEffect(() => {
    const changed = () => setRoute(parseRoute(window.location.hash));
    window.addEventListener('hashchange', changed);
    return () => window.removeEventListener('hashchange', changed);
  }, []);
  return route;
}
