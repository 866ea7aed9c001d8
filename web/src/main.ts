import * as Plotly from 'plotly.js-cartesian-dist-min';
import { cornerFigure, pathFigure } from './corners';
import type { Forces, Monitor, Report, Smooth } from './data';
import { convergenceFigure, stabilisationFigure } from './fit';
import { engagementFigure, gammaFigure, programFigure, revolutionFigure } from './forces';
import { frfFigure, prefersLogFrequency } from './frf';
import { lobesFigure, mapFigure, pairFigure } from './lobes';
import { rocFigure, scoreFigure, spectrogramFigure, waveFigure } from './monitor';
import { polarFigure } from './polar';
import { jointFigure, speedFigure } from './smooth';
import { spectrumFigure } from './spectrum';
import { trackFigure } from './track';
import { dark, light, type Figure, type Theme } from './theme';

type Draw = (theme: Theme, width: number) => Figure;
interface Plot {
  root: HTMLElement;
  draw: Draw;
}

const config = {
  displaylogo: false,
  responsive: true,
  modeBarButtonsToRemove: ['lasso2d', 'select2d', 'autoScale2d'],
  toImageButtonOptions: { format: 'svg', filename: 'robomill' },
};

const plots: Plot[] = [];
const scheme = window.matchMedia('(prefers-color-scheme: dark)');
let printing = false;

function currentTheme(): Theme {
  return scheme.matches && !printing ? dark : light;
}

/** Draws, unless the place is inside a closed part of the page: it has no width yet and is drawn when it opens. */
async function draw(plot: Plot, width?: number): Promise<void> {
  if (plot.root.offsetParent === null) return;
  try {
    await drawFigure(plot, width);
  } catch (error) {
    plot.root.textContent = 'This plot could not be drawn.';
    console.error(error);
  }
}

async function drawFigure(plot: Plot, width?: number): Promise<void> {
  const room = width ?? plot.root.clientWidth;
  const figure = plot.draw(currentTheme(), room);
  if (width !== undefined) Object.assign(figure.layout, { width, autosize: false });
  const bar = room > 300 && window.innerWidth > 600;
  if (!bar) Object.assign(figure.layout['margin'] as object, { r: 12 });
  await Plotly.react(plot.root, figure.data, figure.layout, { ...config, displayModeBar: bar ? 'hover' : false });
}

function drawAll(): Promise<void[]> {
  return Promise.all(plots.map((plot) => draw(plot)));
}

function element<K extends keyof HTMLElementTagNameMap>(tag: K, className: string, parent: HTMLElement): HTMLElementTagNameMap[K] {
  const made = document.createElement(tag);
  made.className = className;
  parent.append(made);
  return made;
}

/** A group of radio buttons above a plot. */
function choice(figure: HTMLElement, legend: string, names: string[], chosen: number, changed: (index: number) => void): void {
  const group = document.createElement('fieldset');
  group.className = 'choice';
  element('legend', '', group).textContent = legend;
  const id = `choice-${document.querySelectorAll('fieldset.choice').length}`;
  names.forEach((name, index) => {
    const label = element('label', '', group);
    const input = element('input', '', label);
    input.type = 'radio';
    input.name = id;
    input.checked = index === chosen;
    input.addEventListener('change', () => changed(index));
    element('span', '', label).textContent = name;
  });
  const controls = figure.querySelector<HTMLElement>('.controls') ?? document.createElement('div');
  controls.className = 'controls';
  controls.append(group);
  figure.prepend(controls);
}

function add(root: HTMLElement, make: Draw): Plot {
  const plot = { root, draw: make };
  plots.push(plot);
  return plot;
}

function several(canvas: HTMLElement, makers: Draw[]): void {
  canvas.classList.add('several');
  for (const make of makers) add(element('div', 'panel', canvas), make);
}

function addFrf(report: Report, figure: HTMLElement, canvas: HTMLElement): void {
  let shown = 0;
  let logarithmic = report.frfs.some(prefersLogFrequency);
  const plot = add(canvas, (theme) => frfFigure(report.frfs[shown]!, report.modes, logarithmic, theme));
  choice(figure, 'FRF', report.frfs.map((frf) => frf.name), 0, (index) => {
    shown = index;
    void draw(plot);
  });
  choice(figure, 'Frequency', ['linear', 'logarithmic'], logarithmic ? 1 : 0, (index) => {
    logarithmic = index === 1;
    void draw(plot);
  });
}

function addRecording(report: Report, index: number, figure: HTMLElement, canvas: HTMLElement): void {
  const recording = report.recordings[index]!;
  let logarithmic = false;
  const plot = add(canvas, (theme) => spectrumFigure(recording, logarithmic, theme));
  choice(figure, 'Amplitude', ['linear', 'logarithmic'], 0, (chosen) => {
    logarithmic = chosen === 1;
    void draw(plot);
  });
}

function addForces(forces: Forces, which: string | undefined, canvas: HTMLElement): void {
  const { revolution, program, spindle_rotation: rotation } = forces;
  if (which === 'revolution' && revolution) add(canvas, (theme, width) => revolutionFigure(revolution, theme, width < 600));
  else if (which === 'engagement' && revolution) add(canvas, (theme, width) => engagementFigure(revolution.engagement, theme, width < 600));
  else if (which === 'program' && program) add(canvas, (theme) => programFigure(program, theme));
  else if (which === 'track' && program) add(canvas, (theme, width) => trackFigure(program.track, theme, width));
  else if (which === 'gamma' && rotation) add(canvas, (theme, width) => gammaFigure(rotation, theme, width < 600));
}

function addJoints(smooth: Smooth, figure: HTMLElement, canvas: HTMLElement): void {
  let method = 0;
  let joint = 0;
  const plot = add(canvas, (theme) => jointFigure(smooth.methods[method]!, smooth.methods[method]!.motion.joints[joint]!, theme));
  choice(figure, 'Joint', smooth.methods[0]!.motion.joints.map((_, i) => `${i + 1}`), 0, (index) => {
    joint = index;
    void draw(plot);
  });
  if (smooth.methods.length < 2) return;
  choice(figure, 'Method', smooth.methods.map((each) => each.name), 0, (index) => {
    method = index;
    void draw(plot);
  });
}

function addSmooth(smooth: Smooth, which: string | undefined, figure: HTMLElement, canvas: HTMLElement): void {
  if (which === 'smooth-path') add(canvas, (theme, width) => pathFigure(smooth, theme, width));
  else if (which === 'smooth-corners') several(canvas, smooth.corners.map((corner) => (theme, width) => cornerFigure(smooth, corner, theme, width)));
  else if (which === 'smooth-speed') add(canvas, (theme) => speedFigure(smooth, theme));
  else if (which === 'smooth-joint') addJoints(smooth, figure, canvas);
}

function addMonitor(monitor: Monitor, which: string | undefined, canvas: HTMLElement): void {
  if (which === 'monitor-wave') add(canvas, (theme) => waveFigure(monitor, theme));
  else if (which === 'monitor-spectrogram' && monitor.spectrogram) add(canvas, (theme) => spectrogramFigure(monitor, theme));
  else if (which === 'monitor-score') add(canvas, (theme) => scoreFigure(monitor, theme));
}

function addPlot(report: Report, figure: HTMLElement, canvas: HTMLElement): void {
  const [which, index] = (figure.dataset['plot'] ?? '').split(':');
  const all = report.lobes[0];
  if (which === 'lobes' && all) {
    const { other_limits: otherLimits, cuts, recommendation, alternatives } = report;
    add(canvas, (theme, width) => lobesFigure({ lobes: all, otherLimits, cuts, recommendation, alternatives }, theme, width < 600));
  } else if (which === 'map' && all) {
    add(canvas, (theme) => mapFigure(all, theme));
  } else if (which === 'pairs' && all) {
    several(canvas, report.lobes.slice(1).map((part) => (theme) => pairFigure(part, all, report.cuts, theme)));
  } else if (which === 'feed' && report.feed_directions) {
    const feed = report.feed_directions;
    const parts: ('lowest' | 'speed')[] = feed.limit_at_speed_mm ? ['lowest', 'speed'] : ['lowest'];
    several(canvas, parts.map((part) => (theme, width) => polarFigure(feed, part, theme, width)));
  } else if (which === 'frf') {
    addFrf(report, figure, canvas);
  } else if (which === 'recording') {
    addRecording(report, Number(index), figure, canvas);
  } else if (which === 'convergence' && report.fit) {
    const { fit } = report;
    add(canvas, (theme) => convergenceFigure(fit, theme));
  } else if (which === 'stabilisation' && report.fit) {
    const { fit } = report;
    add(canvas, (theme) => stabilisationFigure(fit, theme));
  } else if (which?.startsWith('smooth-')) {
    if (report.smooth) addSmooth(report.smooth, which, figure, canvas);
  } else if (which?.startsWith('monitor-')) {
    if (report.monitor) addMonitor(report.monitor, which, canvas);
  } else if (which === 'calibration-roc' && report.calibration) {
    const { calibration } = report;
    add(canvas, (theme, width) => rocFigure(calibration, theme, width < 600));
  } else if (report.forces) {
    addForces(report.forces, which, canvas);
  }
}

/** A4 between its margins, at 96 pixels an inch. */
const paperWidth = 680;

async function start(): Promise<void> {
  const report = JSON.parse(document.getElementById('report-data')?.textContent ?? '{}') as Report;
  for (const figure of document.querySelectorAll<HTMLElement>('figure[data-plot]')) {
    const canvas = figure.querySelector<HTMLElement>('.canvas');
    if (canvas) addPlot(report, figure, canvas);
  }
  for (const part of document.querySelectorAll('details')) {
    part.addEventListener('toggle', () => {
      if (!part.open) return;
      for (const plot of plots) if (part.contains(plot.root)) void draw(plot);
    });
  }
  scheme.addEventListener('change', () => void drawAll());
  window.addEventListener('beforeprint', () => {
    printing = true;
    for (const plot of plots) void draw(plot, plot.root.classList.contains('panel') ? paperWidth / 2 - 10 : paperWidth);
  });
  window.addEventListener('afterprint', () => {
    printing = false;
    void drawAll();
  });
  await drawAll();
  document.documentElement.dataset['plots'] = 'ready';
}

void start();
