// A plot's place in the page, and when it is drawn.
import * as Plotly from 'plotly.js-cartesian-dist-min';
import type { ComponentChildren } from 'preact';
import { useLayoutEffect, useRef } from 'preact/hooks';
import { dark, light, type Figure, type Theme } from './figures/theme';

export type Draw = (theme: Theme, width: number) => Figure;
/** Below this width a plot is arranged for a telephone. */
export const narrow = 600;

interface Place {
  root: HTMLElement;
  draw: Draw;
  width: number; // at which it was drawn last
  picked: ((x: number) => void) | undefined; // where a point was clicked
  drawn: ((root: HTMLElement) => void) | undefined;
}

/** What Plotly makes of the element. */
interface Plotted {
  on?: (event: 'plotly_click', listener: (event: { points: { x: number }[] }) => void) => void;
  removeAllListeners?: (event: 'plotly_click') => void;
}

const config = {
  displaylogo: false,
  modeBarButtonsToRemove: ['lasso2d', 'select2d', 'autoScale2d'],
  toImageButtonOptions: { format: 'svg', filename: 'robomill' },
};

const places = new Set<Place>();
const darkScheme = () => window.matchMedia('(prefers-color-scheme: dark)');
let printing = false;
let drawing = false; // drawAll was called: a place that comes later is drawn when it comes

/** Draws, unless the place is inside a closed part of the page: it has no width yet and is drawn when it opens. */
async function draw(place: Place, width?: number): Promise<void> {
  const { root, draw: make } = place;
  if (root.offsetParent === null) return;
  try {
    const room = width ?? root.clientWidth;
    place.width = room;
    const figure = make(darkScheme().matches && !printing ? dark : light, room);
    if (width !== undefined) Object.assign(figure.layout, { width, autosize: false });
    const bar = room > 300 && window.innerWidth > narrow;
    if (!bar) Object.assign(figure.layout['margin'] as object, { r: 12 });
    await Plotly.react(root, figure.data, figure.layout, { ...config, displayModeBar: bar ? 'hover' : false });
    if (place.picked) listen(root as Plotted, place);
    place.drawn?.(root);
  } catch (error) {
    root.textContent = 'This plot could not be drawn.';
    console.error(error);
  }
}

function listen(root: Plotted, place: Place): void {
  root.removeAllListeners?.('plotly_click');
  root.on?.('plotly_click', ({ points }) => {
    const x = points[0]?.x;
    if (x !== undefined) place.picked?.(x);
  });
}

/** Draws every plot that can be seen, anew. */
export function drawAll(): Promise<void[]> {
  drawing = true;
  return Promise.all([...places].map((place) => draw(place)));
}

/** A4 between its margins, at 96 pixels an inch. */
const paperWidth = 680;

/** Draws anew what has another width now. Plotly would do it, but forgets the height at every second time. */
function drawResized(): void {
  if (printing) return;
  for (const place of places) if (place.root.clientWidth !== place.width) void draw(place);
}

/** Draws anew when the window's width or the colours change, a part of the page opens, or the page is printed. */
export function drawOnEvents(): void {
  let due = 0;
  window.addEventListener('resize', () => {
    cancelAnimationFrame(due);
    due = requestAnimationFrame(drawResized);
  });
  darkScheme().addEventListener('change', () => void drawAll());
  document.addEventListener(
    'toggle',
    ({ target }) => {
      if (!(target instanceof HTMLDetailsElement) || !target.open) return;
      for (const place of places) if (target.contains(place.root)) void draw(place);
    },
    true, // a toggle event does not bubble
  );
  window.addEventListener('beforeprint', () => {
    printing = true;
    for (const place of places) void draw(place, place.root.classList.contains('panel') ? paperWidth / 2 - 10 : paperWidth);
  });
  window.addEventListener('afterprint', () => {
    printing = false;
    void drawAll();
  });
}

/** Calls now and whenever the page gets other colours; what it gives ends that. Paper is light. */
export function onColours(changed: (isDark: boolean) => void): () => void {
  const scheme = darkScheme();
  const asShown = () => changed(scheme.matches);
  const asPrinted = () => changed(false);
  asShown();
  scheme.addEventListener('change', asShown);
  window.addEventListener('beforeprint', asPrinted);
  window.addEventListener('afterprint', asShown);
  return () => {
    scheme.removeEventListener('change', asShown);
    window.removeEventListener('beforeprint', asPrinted);
    window.removeEventListener('afterprint', asShown);
  };
}

interface CanvasProps extends Partial<Pick<Place, 'picked' | 'drawn'>> {
  make: Draw;
  name: string;
  shows?: string;
}

/** Draws when its drawing changes; until drawAll was called, that does it the first time. */
function Canvas({ make, name, shows, picked, drawn }: CanvasProps) {
  const root = useRef<HTMLDivElement>(null);
  const place = useRef<Place | null>(null);
  useLayoutEffect(() => {
    const own: Place = { root: root.current!, draw: make, width: 0, picked, drawn };
    place.current = own;
    places.add(own);
    if (drawing) void draw(own);
    return () => void places.delete(own);
  }, []);
  useLayoutEffect(() => {
    if (place.current === null) return;
    place.current.picked = picked;
    place.current.drawn = drawn;
    if (place.current.draw === make) return;
    place.current.draw = make;
    void draw(place.current);
  });
  return <div ref={root} class={name} {...(shows === undefined ? {} : { role: 'img', 'aria-label': shows })} />;
}

interface PlotProps {
  which: string;
  shows: string; // to someone who cannot see it
  caption: string;
  draw: Draw | Draw[]; // several: side by side
  picked?: (x: number) => void; // where a point of a single plot was clicked
  drawn?: (root: HTMLElement) => void; // after each drawing of a single plot
  children?: ComponentChildren; // what chooses above the plot
}

export function Plot({ which, shows, caption, draw: make, picked, drawn, children }: PlotProps) {
  return (
    <figure data-plot={which}>
      {children && <div class="controls">{children}</div>}
      {Array.isArray(make) ? (
        <div class="canvas several" role="img" aria-label={shows}>
          {make.map((each) => (
            <Canvas make={each} name="panel" />
          ))}
        </div>
      ) : (
        <Canvas make={make} name="canvas" shows={shows} picked={picked} drawn={drawn} />
      )}
      <figcaption>{caption}</figcaption>
    </figure>
  );
}

interface ChoiceProps {
  legend: string;
  names: string[];
  chosen: number;
  choose: (index: number) => void;
}

let groups = 0;

/** Of an axis. */
export function LogChoice({ legend, logarithmic, choose }: { legend: string; logarithmic: boolean; choose: (logarithmic: boolean) => void }) {
  return <Choice legend={legend} names={['linear', 'logarithmic']} chosen={Number(logarithmic)} choose={(chosen) => choose(chosen === 1)} />;
}

/** A group of radio buttons above a plot. */
export function Choice({ legend, names, chosen, choose }: ChoiceProps) {
  const group = useRef(0);
  if (group.current === 0) group.current = ++groups;
  return (
    <fieldset class="choice">
      <legend>{legend}</legend>
      {names.map((name, index) => (
        <label>
          <input type="radio" name={`choice-${group.current}`} checked={index === chosen} onChange={() => choose(index)} />
          <span>{name}</span>
        </label>
      ))}
    </fieldset>
  );
}
