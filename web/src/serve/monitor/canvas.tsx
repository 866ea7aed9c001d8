// The live spectrogram on a canvas that is moved, not drawn anew.
import { useEffect, useRef } from 'preact/hooks';
import { dark, light, type Theme } from '../../figures/theme';
import { onColours } from '../../plot';
import { fixed } from '../../text';
import type { MonitorFeed } from './feed';
import { deepest_db, Painter, referenceFor, scaleStops, ticks, type Picture } from './paint';
import type { FrameRing } from './ring';

const height = 260;
const stripHeight = 48;

interface Surface {
  canvas: HTMLCanvasElement;
  context: CanvasRenderingContext2D;
  column: ImageData;
}

function surfaceOf(canvas: HTMLCanvasElement, width: number, rows: number): Surface {
  canvas.width = width;
  canvas.height = rows;
  return { canvas, context: canvas.getContext('2d', { alpha: false })!, column: new ImageData(1, rows) };
}

/** Both pictures, as far as they are drawn. */
export class Scroller {
  private painter: Painter | null = null;
  private surfaces: [Surface, Surface] | null = null;
  private end: number | null = null; // behind the last pixel that was drawn

  constructor(
    private readonly ring: FrameRing,
    private readonly canvases: [HTMLCanvasElement, HTMLCanvasElement],
    private readonly picture: Omit<Picture, 'theme'>,
  ) {}

  /** All of it at the next drawing. */
  restart(theme: Theme): void {
    const width = this.canvases[0].clientWidth;
    if (width === 0) return;
    this.surfaces = [surfaceOf(this.canvases[0], width, height), surfaceOf(this.canvases[1], width, stripHeight)];
    // Without an alpha channel a canvas is black until it is drawn on.
    for (const { canvas, context } of this.surfaces) {
      context.fillStyle = theme.panel;
      context.fillRect(0, 0, canvas.width, canvas.height);
    }
    this.painter = new Painter(this.ring, { ...this.picture, theme }, height, stripHeight, this.picture.span_s / width);
    this.end = null;
  }

  draw(theme: Theme): void {
    if (this.surfaces === null || this.canvases[0].width !== this.canvases[0].clientWidth) this.restart(theme);
    const { painter, surfaces } = this;
    if (painter === null || surfaces === null || this.ring.size === 0) return;
    const { width } = surfaces[0].canvas;
    const target = painter.pixelAt(this.ring.latest_s);
    const reference = referenceFor(this.ring.peakSince(this.ring.latest_s - this.picture.span_s), this.end === null ? null : painter.reference_db);
    const moved = this.end === null || reference !== painter.reference_db ? width : Math.min(width, target - this.end);
    painter.reference_db = reference;
    if (moved <= 0) return;
    if (moved < width) for (const { canvas, context } of surfaces) context.drawImage(canvas, -moved, 0);
    for (let x = width - moved; x < width; ++x) {
      painter.paint(target - width + x, surfaces[0].column.data, surfaces[1].column.data);
      for (const { context, column } of surfaces) context.putImageData(column, x, 0);
    }
    this.end = target;
  }
}

interface SpectrogramProps extends Omit<Picture, 'theme'> {
  ring: FrameRing;
  id: number;
  feed: MonitorFeed;
}

export function FrequencyAxis({ highest_hz }: { highest_hz: number }) {
  return (
    <div class="frequency-axis" aria-hidden="true">
      {ticks(highest_hz, 6).map((tick) => (
        <span style={{ bottom: `${(100 * tick) / highest_hz}%` }}>{fixed(tick, 0)} Hz</span>
      ))}
    </div>
  );
}

function Legend() {
  const bar = (theme: Theme) => `linear-gradient(to right, ${scaleStops(theme).map(([at, colour]) => `${colour} ${100 * at}%`).join(', ')})`;
  return (
    <div class="colour-bar">
      <div class="scale live-scale" style={{ '--light': bar(light), '--dark': bar(dark) }} />
      <div class="ends">
        <span>{deepest_db} dB below the highest</span>
        <span>the highest</span>
      </div>
    </div>
  );
}

export function LiveSpectrogram({ ring, id, feed, edges_hz, teeth, highest_hz, span_s }: SpectrogramProps) {
  const upper = useRef<HTMLCanvasElement>(null);
  const lower = useRef<HTMLCanvasElement>(null);
  useEffect(() => {
    const scroller = new Scroller(ring, [upper.current!, lower.current!], { edges_hz, teeth, highest_hz, span_s });
    let theme = light;
    let due = 0;
    const draw = () => {
      due = 0;
      scroller.draw(theme);
    };
    const ask = () => void (due ||= requestAnimationFrame(draw));
    const ends = [
      onColours((isDark) => {
        theme = isDark ? dark : light;
        scroller.restart(theme);
        ask();
      }),
      feed.messages.listen((message) => message.id === id && ask()),
    ];
    const resized = new ResizeObserver(ask);
    resized.observe(upper.current!);
    return () => {
      cancelAnimationFrame(due);
      resized.disconnect();
      for (const end of ends) end();
    };
  }, [ring, id, feed, edges_hz, teeth, highest_hz, span_s]);
  const cut = teeth === null ? 'multiples of the rotation' : 'multiples of tooth passing';
  return (
    <figure data-plot="monitor-live">
      <div class="live-spectrogram">
        <FrequencyAxis highest_hz={highest_hz} />
        <canvas ref={upper} style={{ height: `${height}px` }} role="img" aria-label={`Spectrogram of the last ${span_s / 60} minutes up to ${highest_hz} Hz; the numbers above say what it shows now`} />
        <span class="strip-title">Score</span>
        <canvas ref={lower} style={{ height: `${stripHeight}px` }} role="img" aria-label="Score over its threshold, on the colour of the state" />
        <div class="time-axis" aria-hidden="true">
          <span>{span_s / 60} min ago</span>
          <span>now</span>
        </div>
      </div>
      <Legend />
      <figcaption>Dashed: {cut}; dashes in the colour of chatter: its frequency. Below, the score as a bar that reaches the line in the middle at its threshold, over the state: green stable, yellow transition, red chatter, grey undetermined.</figcaption>
    </figure>
  );
}
