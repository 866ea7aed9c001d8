// The application: navigation, the view that the address asks for, and what the server says of its own accord.
import { useEffect, useMemo, useRef, useState } from 'preact/hooks';
import { openApi } from './api';
import { ServeContext } from './context';
import type { FolderState, ServeConfig, Tap } from './documents';
import { listen } from './events';
import { FilesView } from './files';
import { JobView } from './job';
import { JobsView } from './jobs';
import { laterTap, withFolder, withJob } from './later';
import { LobesView } from './lobes';
import { MonitorView } from './monitor';
import { monitorFeed } from './monitor_feed';
import { goTo, href, useRoute, type Route, type View } from './route';
import { TapView } from './tap';

const links: { view: View; name: string }[] = [
  { view: 'files', name: 'Files' },
  { view: 'jobs', name: 'Jobs' },
  { view: 'lobes', name: 'Lobes' },
  { view: 'tap', name: 'Tap test' },
  { view: 'monitor', name: 'Monitor' },
];

export function Bar({ folder, view }: { folder: string; view: View }) {
  return (
    <div class="top-bar">
      <span class="brand">
        <strong>robomill</strong> {folder}
      </span>
      <nav aria-label="Views">
        {links.map((link) => (
          <a href={href(link.view)} aria-current={link.view === view || (view === 'job' && link.view === 'files') ? 'page' : undefined}>
            {link.name}
          </a>
        ))}
      </nav>
    </div>
  );
}

function Shown({ view, path }: Route) {
  switch (view) {
    case 'job':
      return <JobView key={path} path={path} />;
    case 'jobs':
      return <JobsView path={path} />;
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

/** The folder, its jobs and the tap test, kept up to date. */
function useServer(api: ReturnType<typeof openApi>) {
  const [folder, setFolder] = useState<FolderState | null>(null);
  const [tap, setTap] = useState<Tap | null>(null);
  const tookTap = (got: Tap | null) => setTap((known) => laterTap(known, got));
  const [up, setUp] = useState(true);
  const fail = () => setUp(false);
  const refresh = () =>
    void api.state().then((state) => {
      setFolder((known) => withFolder(known, state));
      setUp(true);
    }, fail);
  const all = () => {
    refresh();
    api.tap().then(tookTap, fail);
  };
  useEffect(() => {
    all();
    let first = true;
    return listen({
      files: refresh,
      job: (job) => setFolder((known) => withJob(known, job)),
      tap: setTap,
      monitor: monitorFeed.messages.say,
      monitors: () => monitorFeed.changes.say(),
      connected: (now) => {
        if (now && !first) {
          all();
          monitorFeed.reconnected.say();
        }
        first = false;
        setUp(now);
      },
    });
  }, []);
  return { folder, tap, tookTap, up, refresh };
}

/** Files dropped anywhere on the page, and whether some are held over it. */
function useDropped() {
  const [dropped, setDropped] = useState<File[]>([]);
  const [over, setOver] = useState(false);
  const take = (files: File[]) => {
    setDropped(files);
    if (files.length > 0) goTo('files');
  };
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
      take([...event.dataTransfer.files]);
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
  return { dropped, take, over };
}

/** A link to a place in the page ("#modes") goes there and leaves the address, which says the view. */
function follow(event: MouseEvent): void {
  const link = (event.target as Element).closest?.('a[href^="#"]:not([href^="#/"])');
  if (!link) return;
  event.preventDefault();
  const place = document.getElementById(link.getAttribute('href')!.slice(1));
  place?.scrollIntoView();
  place?.focus();
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

export function App({ config }: { config: ServeConfig }) {
  const api = useMemo(() => openApi(config), [config]);
  const route = useRoute();
  const { folder, tap, tookTap, up, refresh } = useServer(api);
  const { dropped, take, over } = useDropped();
  const [said, announce] = useState('');
  useOpened(route, config.folder);
  return (
    <ServeContext value={{ api, folder, tap, tookTap, announce, refresh, dropped, take }}>
      <div class={over ? 'app over-page' : 'app'} onClick={follow}>
        <a class="skip" href="#view">
          Skip to the content
        </a>
        <Bar folder={config.folder} view={route.view} />
        {!up && (
          <p class="down" role="alert">
            The server does not answer. Is <code>robomill serve</code> still running? This page tries again by itself.
          </p>
        )}
        <main id="view" tabIndex={-1}>
          <Shown {...route} />
        </main>
        <p class="quiet" role="status" aria-live="polite">
          {said}
        </p>
      </div>
    </ServeContext>
  );
}
