// The drawing of an assembly, to scale, as SVG that takes its colours from the page.
import type { Assembly } from '../views';
import { layOut, viewWidth, type Shape } from './drawing_layout';

function tenths(value: number): string {
  return value.toFixed(1);
}

function draw(shape: Shape) {
  switch (shape.shape) {
    case 'box':
      return <rect class={shape.kind} x={tenths(shape.x)} y={tenths(shape.y)} width={tenths(shape.width)} height={tenths(shape.height)} />;
    case 'line': {
      const [[x1, y1], [x2, y2]] = [shape.from.map(tenths), shape.to.map(tenths)];
      return <line class={shape.kind} x1={x1} y1={y1} x2={x2} y2={y2} />;
    }
    case 'path':
      return <polyline class={shape.kind} points={shape.points.map((point) => point.map(tenths).join(',')).join(' ')} />;
    case 'dot':
      return <circle class="point" cx={tenths(shape.at[0])} cy={tenths(shape.at[1])} r="3" />;
    case 'label':
      return (
        <text x={tenths(shape.at[0])} y={tenths(shape.at[1])} text-anchor={shape.anchor}>
          {shape.text}
        </text>
      );
  }
}

export function AssemblyDrawing({ assembly }: { assembly: Assembly }) {
  const { height, words, shapes } = layOut(assembly);
  return (
    <figure>
      <div class="drawing">
        <svg class="assembly" viewBox={`0 0 ${viewWidth} ${height.toFixed(0)}`} role="img" aria-label={words}>
          <defs>
            <pattern id="flutes" width="9" height="9" patternUnits="userSpaceOnUse" patternTransform="rotate(-60)">
              <line class="flute" x1="0" y1="0" x2="0" y2="9" />
            </pattern>
            <pattern id="wall" width="7" height="7" patternUnits="userSpaceOnUse" patternTransform="rotate(45)">
              <line class="hatch" x1="0" y1="0" x2="0" y2="7" />
            </pattern>
          </defs>
          {shapes.map(draw)}
        </svg>
      </div>
      <figcaption>
        To scale, but for the joint's symbol; lengths and diameters in mm. Hatched: flutes, at their nominal diameter. Dashed: bores
        (outer/inner diameter).
      </figcaption>
    </figure>
  );
}
