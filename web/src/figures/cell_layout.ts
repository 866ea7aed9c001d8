// What stands where in the picture of a cell: seen from the side and from above, to one scale.
import type { CellDocument, CellFigure, Vector } from '../documents';
import { general } from '../text';

export type Point = [x: number, y: number];

export const viewWidth = 900;
const margin = 28;
const gap = 40; // between the views
const heading = 26;
const tallest = 520;
const axisLength = 0.09; // of a frame, as a share of the picture's width in millimetres

/** A frame as three arrows from its origin. */
export interface FrameMark {
  kind: 'base' | 'workpiece' | 'proposal';
  name: string; // of a proposal its number
  origin: Point;
  axes: { name: 'x' | 'y' | 'z'; to: Point }[];
}

/** The machine at one posture. */
export interface FigureLines {
  name: string;
  kind: 'home' | 'shown'; // home is drawn faintly where another one is there
  links: Point[][];
  tool: Point[]; // flange and tip
  joints: { label: string; at: Point }[]; // those that coincide share a label
}

export interface CellView {
  title: string;
  reach: Point[][];
  figures: FigureLines[];
  frames: FrameMark[]; // base, workpiece, proposals
  program: Point[];
  misses: Point[];
}

export interface CellPicture {
  height: number;
  words: string;
  views: CellView[];
  bar: { from: Point; to: Point; text: string };
}

interface View {
  title: string;
  across: (point: Vector) => Point; // to the right and up, in millimetres
  reach: [number, number][][];
}

function viewsOf({ drawing }: CellDocument): View[] {
  return [
    { title: 'From the side: x to the right, z up', across: ([x, , z]) => [x, z], reach: drawing.reach_side_mm },
    { title: 'From above: x to the right, y up', across: ([x, y]) => [x, y], reach: drawing.reach_top_mm },
  ];
}

/** The columns of R = Rz Ry Rx. */
export function axesOf([a, b, c]: Vector): Vector[] {
  const [x, y, z] = [a, b, c].map((angle) => (angle * Math.PI) / 180) as Vector;
  const [sx, cx, sy, cy, sz, cz] = [Math.sin(x), Math.cos(x), Math.sin(y), Math.cos(y), Math.sin(z), Math.cos(z)];
  return [
    [cz * cy, sz * cy, -sy],
    [cz * sy * sx - sz * cx, sz * sy * sx + cz * cx, cy * sx],
    [cz * sy * cx + sz * sx, sz * sy * cx - cz * sx, cy * cx],
  ];
}

interface Frame extends Pick<FrameMark, 'kind' | 'name'> {
  origin: Vector;
  axes: Vector[];
}

function framesOf({ placement, proposals }: CellDocument): Frame[] {
  const identity: Vector[] = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
  return [
    { kind: 'base', name: 'base', origin: [0, 0, 0], axes: identity },
    { kind: 'workpiece', name: 'workpiece', origin: placement.origin_mm, axes: axesOf(placement.rotation_deg) },
    ...proposals.map(({ origin_mm, rotation_deg }, i): Frame => ({ kind: 'proposal', name: `${i + 1}`, origin: origin_mm, axes: axesOf(rotation_deg) })),
  ];
}

function pointsOf(document: CellDocument, { across, reach }: View): Point[] {
  const { figures, program_mm } = document.drawing;
  return [
    ...reach.flat(),
    ...figures.flatMap(({ links_mm, flange_mm, tip_mm }) => [...links_mm.flat(), flange_mm, tip_mm]).map(across),
    ...program_mm.map(across),
    ...framesOf(document).map(({ origin }) => across(origin)),
    ...document.placement.misses.map(({ base_tip_mm }) => across(base_tip_mm)),
  ].filter(([x, y]) => Number.isFinite(x) && Number.isFinite(y));
}

interface Bounds {
  low: Point;
  size: Point;
}

function boundsOf(points: Point[]): Bounds {
  const low = points.reduce(([x, y], [u, v]): Point => [Math.min(x, u), Math.min(y, v)], [Infinity, Infinity]);
  const high = points.reduce(([x, y], [u, v]): Point => [Math.max(x, u), Math.max(y, v)], [-Infinity, -Infinity]);
  return { low, size: [Math.max(1, high[0] - low[0]), Math.max(1, high[1] - low[1])] };
}

/** Numbers of the joints, those of one place together. */
function jointLabels(joints: Vector[], place: (point: Vector) => Point): FigureLines['joints'] {
  const out: FigureLines['joints'] = [];
  joints.map(place).forEach((at, i) => {
    const near = out.find(({ at: [x, y] }) => Math.hypot(x - at[0], y - at[1]) < 14);
    if (near) near.label += `, ${i + 1}`;
    else out.push({ label: `${i + 1}`, at });
  });
  return out;
}

function figureLines(figure: CellFigure, alone: boolean, place: (point: Vector) => Point): FigureLines {
  const kind = figure.name === 'home' && !alone ? 'home' : 'shown';
  return {
    name: figure.name,
    kind,
    links: figure.links_mm.map((link) => link.map(place)),
    tool: [figure.flange_mm, figure.tip_mm].map(place),
    joints: kind === 'shown' ? jointLabels(figure.joints_mm, place) : [],
  };
}

function placed(document: CellDocument, view: View, to: (point: Point) => Point, scale: number): CellView {
  const { drawing, placement } = document;
  const place = (point: Vector) => to(view.across(point));
  const reachOf = (outline: [number, number][]) => outline.map(to);
  const frames = framesOf(document).map(({ kind, name, origin, axes }): FrameMark => ({
    kind,
    name,
    origin: place(origin),
    axes: axes.map((axis, i) => {
      const along = (axisLength * viewWidth) / scale / 2;
      return { name: 'xyz'.charAt(i) as 'x' | 'y' | 'z', to: place(origin.map((value, k) => value + along * axis[k]!) as Vector) };
    }),
  }));
  return {
    title: view.title,
    reach: view.reach.map(reachOf),
    figures: drawing.figures.map((figure) => figureLines(figure, drawing.figures.length === 1, place)),
    frames,
    program: drawing.program_mm.length > 1 ? drawing.program_mm.map(place) : [],
    misses: placement.misses.map(({ base_tip_mm }) => place(base_tip_mm)),
  };
}

function inWords({ robot, placement, proposals }: CellDocument): string {
  const what = robot.description ?? (robot.kind === 'serial' ? 'A robot arm' : 'A hybrid machine');
  const where = placement.works ? 'reaches the workpiece' : 'does not reach the workpiece as it stands';
  return `${what} ${where}${proposals.length > 0 ? `; ${proposals.length} other place${proposals.length === 1 ? ' is' : 's are'} marked` : ''}. Seen from the side and from above.`;
}

export function layOutCell(document: CellDocument): CellPicture {
  const views = viewsOf(document);
  const bounds = views.map((view) => boundsOf(pointsOf(document, view)));
  const across = bounds.reduce((sum, { size }) => sum + size[0], 0);
  const up = Math.max(...bounds.map(({ size }) => size[1]));
  const scale = Math.min((viewWidth - 2 * margin - gap * (views.length - 1)) / across, tallest / up);
  const height = heading + 2 * margin + scale * up + 24;
  let left = margin;
  const placedViews = views.map((view, i) => {
    const { low, size } = bounds[i]!;
    const from = left;
    left += scale * size[0] + gap;
    const to = ([x, y]: Point): Point => [from + scale * (x - low[0]), heading + margin + scale * (up - (y - low[1]))];
    return placed(document, view, to, scale);
  });
  const decade = 10 ** Math.floor(Math.log10((0.25 * viewWidth) / scale));
  const length = [5, 2, 1].map((step) => step * decade).find((bar) => bar * scale <= 0.25 * viewWidth) ?? decade;
  const y = height - 14;
  return {
    height,
    words: inWords(document),
    views: placedViews,
    bar: { from: [margin, y], to: [margin + scale * length, y], text: `${general(length, 3)} mm` },
  };
}
