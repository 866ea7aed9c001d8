// The picture of a cell as SVG that takes its colours from the page.
import type { CellDocument } from '../documents';
import { layOutCell, viewWidth, type CellView, type FigureLines, type FrameMark, type Point } from './cell_layout';

function tenths(value: number): string {
  return value.toFixed(1);
}

function pointsText(points: Point[]): string {
  return points.map((point) => point.map(tenths).join(',')).join(' ');
}

function outlineText(outlines: Point[][]): string {
  return outlines.map((outline) => `M${outline.map((point) => point.map(tenths).join(' ')).join('L')}Z`).join('');
}

function Arm({ figure }: { figure: FigureLines }) {
  return (
    <g class={figure.kind}>
      {figure.links.map((link) => (
        <polyline class="link" points={pointsText(link)} />
      ))}
      <polyline class="tool" points={pointsText(figure.tool)} />
      {figure.joints.map(({ label, at: [x, y] }) => (
        <>
          <circle class="joint" cx={tenths(x)} cy={tenths(y)} r="4" />
          <text x={tenths(x + 7)} y={tenths(y - 6)}>
            {label}
          </text>
        </>
      ))}
    </g>
  );
}

function FrameArrows({ frame: { kind, name, origin, axes } }: { frame: FrameMark }) {
  const [x, y] = origin;
  return (
    <g class={`frame ${kind}`}>
      {axes
        .filter(({ to: [u, v] }) => Math.hypot(u - x, v - y) > 2)
        .map(({ name: axis, to: [u, v] }) => (
          <>
            <line x1={tenths(x)} y1={tenths(y)} x2={tenths(u)} y2={tenths(v)} />
            {kind !== 'proposal' && (
              <text class="axis" x={tenths(u + 3)} y={tenths(v + 4)}>
                {axis}
              </text>
            )}
          </>
        ))}
      <circle cx={tenths(x)} cy={tenths(y)} r="3" />
      <text x={tenths(kind === 'proposal' ? x - 14 : x + 5)} y={tenths(kind === 'proposal' ? y - 5 : y + 17)}>
        {name}
      </text>
    </g>
  );
}

function View({ view }: { view: CellView }) {
  const left = Math.min(...view.frames.map(({ origin }) => origin[0]), ...view.reach.flat().map(([x]) => x), ...view.figures.flatMap(({ links }) => links.flat().map(([x]) => x)));
  return (
    <g>
      <text class="title" x={tenths(left)} y="18">
        {view.title}
      </text>
      <path class="reach" fill-rule="evenodd" d={outlineText(view.reach)} />
      {view.figures.map((figure) => (
        <Arm figure={figure} />
      ))}
      {view.program.length > 0 && <polyline class="program" points={pointsText(view.program)} />}
      {view.frames.map((frame) => (
        <FrameArrows frame={frame} />
      ))}
      {view.misses.map(([x, y]) => (
        <circle class="miss" cx={tenths(x)} cy={tenths(y)} r="4" />
      ))}
    </g>
  );
}

export function CellDrawing({ document }: { document: CellDocument }) {
  const { height, words, views, bar } = layOutCell(document);
  const several = document.drawing.figures.length > 1;
  return (
    <figure>
      <div class="drawing">
        <svg class="cell-drawing" viewBox={`0 0 ${viewWidth} ${height.toFixed(0)}`} role="img" aria-label={words}>
          {views.map((view) => (
            <View view={view} />
          ))}
          <line class="bar" x1={tenths(bar.from[0])} y1={tenths(bar.from[1])} x2={tenths(bar.to[0])} y2={tenths(bar.to[1])} />
          <text x={tenths(bar.to[0] + 8)} y={tenths(bar.to[1] + 5)}>
            {bar.text}
          </text>
        </svg>
      </div>
      <figcaption>
        Joints by their numbers, the tool thick, frames as arrows.{several ? ' Faint: home.' : ''} Tinted: where the wrist (joint 5) can be, from the side with joint 1 at
        0. Dots in red: poses that cannot be taken; dashed, by their numbers: where the workpiece could stand.
      </figcaption>
    </figure>
  );
}
