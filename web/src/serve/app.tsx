// The application: navigation, the view that the address asks for, and what the server says of its own accord.
import { useEffect, useMemo, useRef, useState } from 'preact/hooks';
import { Contained } from '../page';
import { openApi, type ApiError } from './api';
import { ArrivalsContext, useArrivals } from './files/arrivals';
import { ServeContext } from './context';
import type { ServeConfig } from './documents';
import { FilesView } from './files/files';
import { JobView } from './files/job';
import { JobsView } from './jobs/jobs';
import { LobesView } from './lobes/lobes';
import { MonitorView } from './monitor/monitor';
import { belongsTo } from './overview/belongs';
import { OverviewsContext, readable, useChosen, useOverviews } from './overview/chosen';
import { OverviewView } from './overview/overview';
import { pathIn } from './overview/stages';
import { FaultText } from './pieces';
import { ProgramView } from './program/program';
import { goTo, href, useRoute, type Route, type View } from './route';
import { useServer } from './server';
import { TapView } from './tap/tap';

const links: { view: View; name: string }[] = [
  { view: 'overview', name: 'Job' },
  { view: 'files', name: 'Files' },
  { view: 'jobs', name: 'Jobs' },
  { view: 'program', name: 'Program' },
  { view: 'lobes', name: 'Lobes' },
  { view: 'tap', name: 'Tap test' },
  { view: 'monitor', name: 'Monitor' },
];

/** `pathOf`: the file that a view shows of the chosen job. */
export function Bar({ folder, view, pathOf = () => '' }: { folder: string; view: View; pathOf?: (view: View) => string }) {
  return (
    <div class="top-bar">
      <span class="brand">
        <strong>robomill</strong> {folder}
      </span>
      <nav aria-label="Views">
        {links.map((link) => (
          <a href={href(link.view, pathOf(link.view))} aria-current={link.view === view || (view === 'job' && link.view === 'files') ? 'page' : undefined}>
            {link.name}
          </a>
        ))}
      </nav>
    </div>
  );
}

/** A view that fails leaves the navigation, and is tried again when another is opened. */
function Shown(route: Route) {
  return (
    <Contained about={href(route.view, route.path)}>
      <ViewAt {...route} />
    </Contained>
  );
}

function ViewAt({ view, path }: Route) {
  switch (view) {
    case 'job':
      return <JobView key={path} path={path} />;
    case 'jobs':
      return <JobsView path={path} />;
    case 'overview':
      return <OverviewView path={path} />;
    case 'program':
      return <ProgramView key={/^\d*$/.test(path) ? '' : path} path={path} />;
    case 'lobes':
      return <LobesView path={path} />;
    case 'tap':
      return <TapView path={path} />;
    case 'monitor':
      return <MonitorView path={path} />;
    case 'files':
      return <FilesView />;
  }
}

/** Takes files that are dropped anywhere on the page; whether some are held over it. */
function useDropped(take: (files: File[]) => void): boolean {
  const [over, setOver] = useState(false);
  const taken = useRef(take);
  taken.current = take;
  useEffect(() => {
    const hold = (event: DragEvent) => {
      if (!event.dataTransfer?.types.includes('Files')) return;
      event.preventDefault();
      setOver(true);
    };
    const leave = (event: DragEvent) => event.relatedTarget === null && setOver(false);
    const drop = (event: DragEvent) => {
      setOver(false);
      if (!event.dataTransfer || event.dataTransfer.files.length === 0) return;
      event.preventDefault();
      taken.current([...event.dataTransfer.files]);
    };
    window.addEventListener('dragover', hold);
    window.addEventListener('dragleave', leave);
    window.addEventListener('drop', drop);
    return () => {
      window.removeEventListener('dragover', hold);
      window.removeEventListener('dragleave', leave);
      window.removeEventListener('drop', drop);
    };
  }, []);
  return over;
}

/** A link to a place in the page ("#modes") goes there and leaves the address, which says the view. */
export function follow(event: MouseEvent): void {
  if (event.button !== 0 || event.ctrlKey || event.metaKey || event.shiftKey || event.altKey) return; // into another tab
  const link = (event.target as Element).closest?.('a[href^="#"]:not([href^="#/"])');
  if (!link) return;
  event.preventDefault();
  const place = document.getElementById(link.getAttribute('href')!.slice(1));
  if (!place) return;
  if (place.tabIndex < 0) place.tabIndex = -1; // a section can have the focus only then
  place.scrollIntoView();
  place.focus({ preventScroll: true });
}

/** A view that opens takes the focus to its heading and is named in the window's title. */
function useOpened(route: Route, folder: string): void {
  const first = useRef(true);
  useEffect(() => {
    const heading = document.querySelector<HTMLElement>('#view h1');
    document.title = `${heading?.textContent ?? 'robomill'} · robomill ${folder}`;
    if (!first.current) {
      window.scrollTo(0, 0);
      heading?.focus({ preventScroll: true });
    }
    first.current = false;
  }, [route.view, route.path]);
}

/** What is said after another text: the same once more differs in a space, or it would be no news. */
export function saidAfter(before: string, text: string): string {
  return before === text ? `${text}\u00a0` : text;
}

export function Trouble({ error: { status, fault } }: { error: ApiError }) {
  return (
    <p class="down" role="alert">
      {status === 0 ? (
        <>
          The server does not answer. Is <code>robomill serve</code> still running? This page tries again by itself.
        </>
      ) : (
        <>
          The server answers with an error, and this page asks again: <FaultText fault={fault} />
        </>
      )}
    </p>
  );
}

export function App({ config }: { config: ServeConfig }) {
  const api = useMemo(() => openApi(config), [config]);
  const route = useRoute();
  const { folder, verbs, tap, tookTap, trouble, refresh } = useServer(api);
  const [said, say] = useState('');
  const announce = (text: string) => say((before) => saidAfter(before, text));
  const received = useArrivals({ api, folder, refresh, announce });
  const overviews = useOverviews(api, folder);
  const chosen = useChosen(route, folder);
  const known = readable(overviews);
  const job = known.find(({ file }) => file === chosen) ?? null;
  const take = (files: File[]) => {
    if (route.view === 'overview') return received.take(files, job ? belongsTo(api, job, folder?.record_endings ?? []) : undefined);
    received.take(files);
    goTo('files');
  };
  const over = useDropped(take);
  useOpened(route, config.folder);
  return (
    <ServeContext value={{ api, folder, verbs, tap, tookTap, announce, refresh, take }}>
      <div class={over ? 'app over-page' : 'app'} onClick={follow}>
        <a class="skip" href="#view">
          Skip to the content
        </a>
        <Bar folder={config.folder} view={route.view} pathOf={(view) => pathIn(view, job, known)} />
        {trouble && <Trouble error={trouble} />}
        <main id="view" tabIndex={-1}>
          <ArrivalsContext value={received}>
            <OverviewsContext value={overviews}>
              <Shown {...route} />
            </OverviewsContext>
          </ArrivalsContext>
        </main>
        <p class="quiet" role="status" aria-live="polite">
          {said}
        </p>
      </div>
    </ServeContext>
  );
}
