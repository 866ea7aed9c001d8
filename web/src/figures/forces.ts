import type { Block, Num, Program, Revolution, Ring, SpindleRotation } from '../documents';
import { valueAt } from '../views';
import { highest, limitMarks, reach, stack, suffix } from './rows';
import { axis, layout, lines, points, thinSpace, type Figure, type Layout, type Theme, type Trace } from './theme';

const turnAxis = 'Rotation φ from +y (°)';

/** Ticks of an angle that suit its range and the room: 45° apart within a turn, wider over several or where narrow. */
export function turnTicks(from: number, to: number, narrow: boolean): Layout {
  return { range: [from, to], tick0: 0, dtick: (narrow ? 90 : 45) * Math.max(1, Math.ceil((to - from) / 360)) };
}

/** Fx, Fy and Fz over the rotation, with the vibration where it was simulated. */
export function forceCurves(turn: Revolution): [number[], number[], number[]] {
  return [turn.vibrating_fx_n ?? turn.fx_n, turn.vibrating_fy_n ?? turn.fy_n, turn.vibrating_fz_n ?? turn.fz_n];
}

/** Fx, Fy and Fz over the rotation, the torque below. */
export function revolutionFigure(turn: Revolution, theme: Theme, narrow = false): Figure {
  const x = turn.rotation_deg;
  const [fx, fy, fz] = forceCurves(turn);
  const line = (name: string, y: number[], index: number, dash: string) =>
    lines(name, x, y, { color: theme.series[index], width: 2, dash }, `%{y:.4g}${thinSpace}N at %{x:.1f}°<extra>${name}</extra>`);
  return {
    data: [
      line('Fx', fx, 0, 'solid'),
      line('Fy', fy, 1, '7px,3px'),
      line('Fz', fz, 2, '2px,2px'),
      lines('torque', x, turn.torque_by_rotation_n_m, { color: theme.text, width: 2 }, `%{y:.4g}${thinSpace}N·m at %{x:.1f}°<extra>torque</extra>`, { yaxis: 'y2', showlegend: false }),
    ],
    layout: layout(theme, 460, {
      hovermode: 'x',
      margin: { l: 64, r: 36, t: 36, b: 48 },
      xaxis: axis(theme, turnAxis, { anchor: 'y2', hoverformat: '.1f', ...turnTicks(x[0] ?? 0, x[x.length - 1] ?? 360, narrow) }),
      yaxis: axis(theme, `Force on the ${turn.force_on} (N)`, { domain: [0.38, 1], zeroline: true, zerolinecolor: theme.muted }),
      yaxis2: axis(theme, 'Torque (N·m)', { domain: [0, 0.3], rangemode: 'tozero' }),
    }),
  };
}

/** An arc as parts of one turn from 0 to 360°: two where it runs over +y. */
export function withinTurn(entry: number, exit: number): [number, number][] {
  if (exit - entry >= 360) return [[0, 360]];
  const from = ((entry % 360) + 360) % 360;
  const to = from + (exit - entry);
  return to <= 360 ? [[from, to]] : [[from, 360], [0, to - 360]];
}

/** Lower and upper edge of each ring: halfway to its neighbours. The lowest stands on the tip where that is near. */
export function ringEdges(heights: number[]): [number, number][] {
  const half = (i: number) => (heights.length > 1 ? (heights[i + 1]! - heights[i]!) / 2 : Math.max(heights[0] ?? 1, 1e-3) / 2);
  return heights.map((height, i) => {
    const below = i > 0 ? half(i - 1) : Math.min(half(0), Math.max(height, 0));
    const above = i + 1 < heights.length ? half(i) : half(Math.max(i - 1, 0));
    return [height - below, height + above];
  });
}

const directions: [number, string][] = [
  [0, '+y'], [45, ''], [90, 'feed'], [135, ''], [180, '−y'], [225, ''], [270, ''], [315, ''], [360, ''],
];

/** Where around the axis, and how high above the tip, teeth are in the material. */
export function engagementFigure(rings: Ring[], theme: Theme, narrow = false): Figure {
  const edges = ringEdges(rings.map((ring) => ring.height_mm));
  const outline = { x: [] as (number | null)[], y: [] as (number | null)[] };
  const middle = { x: [] as number[], y: [] as number[], text: [] as string[] };
  rings.forEach((ring, i) => {
    const [low, high] = edges[i]!;
    for (const [entry, exit] of ring.arcs_deg) {
      for (const [from, to] of withinTurn(entry, exit)) {
        outline.x.push(from, to, to, from, from, null);
        outline.y.push(low, low, high, high, low, null);
        middle.x.push((from + to) / 2);
        middle.y.push(ring.height_mm);
        middle.text.push(`${ring.height_mm.toPrecision(3)}${thinSpace}mm, κ ${ring.position_deg.toFixed(1)}°<br>from ${entry.toFixed(1)}° to ${exit.toFixed(1)}°`);
      }
    }
  });
  const top = edges[edges.length - 1]?.[1] ?? 1;
  const ticks = directions.filter(([at]) => !narrow || at % 90 === 0);
  return {
    data: [
      lines('', outline.x, outline.y, { color: theme.panel, width: 0.8 }, null, { fill: 'toself', fillcolor: theme.accent, opacity: 0.85 }),
      points('', middle.x, middle.y, { size: 14, color: 'rgba(0,0,0,0)' }, '%{text}', { text: middle.text }),
    ],
    layout: layout(theme, 340, {
      hovermode: 'closest',
      showlegend: false,
      xaxis: axis(theme, turnAxis, {
        range: [0, 360],
        tickvals: ticks.map(([at]) => at),
        ticktext: ticks.map(([at, name]) => (name === '' ? `${at}` : `${at}<br>${name}`)),
      }),
      yaxis: axis(theme, 'Height above the tip (mm)', { range: [Math.min(0, edges[0]?.[0] ?? 0), top * 1.03] }),
    }),
  };
}

interface Row {
  title: string;
  unit: string;
  lines: { name: string; y: Num[]; faint?: boolean }[];
  limit: number | null;
}

/** Whether a robot bends along the program. */
export function bends(blocks: Block[]): boolean {
  return blocks.some((block) => block.peak_deflection_um !== null);
}

function programRows({ blocks, torque_limit_n_m: torqueLimit, power_limit_w: powerLimit, power_time_s: powerTime }: Program): Row[] {
  const column = (value: (block: Block) => Num) => blocks.map(value);
  const rows: Row[] = [
    { title: 'Peak force (N)', unit: 'N', lines: [{ name: 'peak force', y: column((block) => block.peak_f_n) }], limit: null },
    {
      title: 'Torque (N·m)',
      unit: 'N·m',
      lines: [
        { name: 'peak torque', y: column((block) => block.peak_torque_n_m), faint: true },
        { name: 'torque over a revolution', y: column((block) => block.revolution_torque_n_m) },
      ],
      limit: torqueLimit,
    },
    { title: 'Power (W)', unit: 'W', lines: [{ name: `power over ${powerTime} s`, y: column((block) => block.sustained_power_w) }], limit: powerLimit },
  ];
  if (bends(blocks)) {
    rows.push({ title: 'Deflection (µm)', unit: 'µm', lines: [{ name: 'deflection', y: column((block) => block.peak_deflection_um) }], limit: null });
  }
  return rows;
}

/** Peak force, torque, power and deflection over the length of the path, one above the other. */
export function programFigure(program: Program, theme: Theme): Figure {
  const { blocks } = program;
  const rows = programRows(program);
  const x = [0, ...blocks.map((block) => block.path_mm)];
  const places = blocks.map(({ block, line }) => [block, line]);
  const first = places[0] ?? [null, null];
  const { data, axes, shapes, annotations } = stack(
    rows.map((row, index) => {
      const most = Math.max(...row.lines.map((line) => highest(line.y))) || 1; // nothing cut: any range will do
      const inside = row.limit !== null && row.limit <= reach * most;
      const traces = row.lines.map(({ name, y, faint }) => {
        const style = { shape: 'vh', width: faint ? 1 : 1.5, color: faint ? theme.measured : theme.accent };
        const hover = `%{y:.4g}${thinSpace}${row.unit} in block %{customdata[0]}, line %{customdata[1]}<extra>${name}</extra>`;
        return lines(name, x, [y[0] ?? null, ...y], style, hover, { showlegend: row.lines.length > 1, yaxis: `y${suffix(index)}`, customdata: [first, ...places] });
      });
      const own = { title: row.title, traces, axis: { range: [0, 1.12 * Math.max(most, inside ? row.limit! * 1.06 : 0)], nticks: 4, exponentformat: 'none' } };
      if (row.limit === null) return own;
      const text = `spindle's limit ${Number(row.limit.toPrecision(3))} ${row.unit}${inside ? '' : ', above this plot'}`;
      return { ...own, marks: limitMarks(index, inside ? [row.limit] : [], text, theme) };
    }),
    0.045,
    theme,
  );
  return {
    data,
    layout: layout(theme, 150 * rows.length + 80, {
      hovermode: 'x',
      margin: { l: 64, r: 36, t: 32, b: 48 },
      xaxis: axis(theme, 'Length of path (mm)', { anchor: `y${rows.length}`, range: [0, x[x.length - 1] ?? 1], hoverformat: '.1f', exponentformat: 'none' }),
      ...axes,
      shapes,
      annotations,
    }),
  };
}

/** Deflection over γ, the best and the used one marked, with the condition number below where it is known. */
export function gammaFigure(sweep: SpindleRotation, theme: Theme, narrow = false): Figure {
  const x = sweep.rotation_deg;
  const conditioned = sweep.condition_number.some((value) => value !== null);
  const bent = `%{y:.4g}${thinSpace}µm at γ = %{x:.4g}°`;
  const mark = (name: string, at: Num, y: Num, symbol: string, color: string): Trace[] =>
    at === null || y === null ? [] : [points(name, [at], [y], { symbol, size: 12, color, line: { width: 2, color } }, `${name}: ${bent}`)];
  const data: Trace[] = [
    // A rotation alone between two out of reach is a point.
    lines('deflection', x, sweep.deflection_um, { color: theme.accent, width: 2 }, bent, { mode: 'lines+markers', showlegend: false, connectgaps: false, marker: { size: 3, color: theme.accent } }),
    ...mark('used', sweep.used_deg, valueAt(x, sweep.deflection_um, sweep.used_deg), 'circle-open', theme.text),
    ...mark('best', sweep.best_deg, sweep.best_deflection_um, 'diamond', theme.stable),
  ];
  if (conditioned) {
    const style = { color: theme.muted, width: 2 };
    data.push(lines('condition number', x, sweep.condition_number, style, 'condition number %{y:.4g} at γ = %{x:.4g}°', { showlegend: false, yaxis: 'y2', connectgaps: false }));
  }
  const [from, to] = [x[0] ?? -180, x[x.length - 1] ?? 180];
  const wide = to - from > 180;
  return {
    data,
    layout: layout(theme, conditioned ? 500 : 320, {
      hovermode: 'closest',
      margin: { l: 64, r: 36, t: 36, b: 48 },
      xaxis: axis(theme, 'Rotation γ (°)', {
        anchor: conditioned ? 'y2' : 'y',
        ...(wide ? turnTicks(from, to, narrow) : { range: [from, to] }),
      }),
      yaxis: axis(theme, 'Deflection (µm)', { domain: conditioned ? [0.4, 1] : [0, 1], rangemode: 'tozero' }),
      ...(conditioned ? { yaxis2: axis(theme, 'Condition number', { domain: [0, 0.33], rangemode: 'tozero', nticks: 4 }) } : {}),
    }),
  };
}
