// The path in three dimensions: a camera that goes around it, and what is under the pointer.
import { Matrix4, OrthographicCamera, Vector3 } from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import type { OpenPath, PathColours, PathData, PathEvents, PathView, Side } from './contract';
import { drawAxes, drawMark } from './overlay';
import { canvasPainter, type Painter } from './painter';
import { boundsOf, cutting, drawn, pick, project, type Bounds } from './project';
import { webglPainter } from './webgl';

const from: Record<Side, [number, number, number]> = {
  corner: [-0.55, -0.75, 0.6],
  above: [0, -1e-4, 1], // not quite: "up" is where y goes
  front: [0, -1, 0],
  right: [1, 0, 0],
};
const turnByKey = 0.12; // rad
const zoomByKey = 1.2;
const still = 4; // px: a click that moved less is none of turning

class PathScene implements PathView {
  private readonly bounds: Bounds;
  private cuts: number[];
  private readonly camera = new OrthographicCamera();
  private readonly over = document.createElement('canvas');
  private readonly controls: OrbitControls;
  private readonly observer: ResizeObserver;
  private painter: Painter;
  private colours: PathColours | null = null;
  private places: Float32Array | null = null;
  private size: [number, number] = [1, 1];
  private selected: number | null = null;
  private hovered: number | null = null;
  private due = 0;
  private pressed: [number, number] | null = null;

  constructor(
    private readonly root: HTMLElement,
    private data: PathData,
    private readonly events: PathEvents,
  ) {
    this.bounds = boundsOf(data);
    this.cuts = drawn(data, cutting);
    this.painter = webglPainter(data) ?? canvasPainter(data);
    root.replaceChildren(this.painter.canvas, this.over);
    this.painter.canvas.addEventListener('webglcontextlost', this.lost);
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, this.over);
    this.controls.enableZoom = false; // until it was clicked: the wheel scrolls the page
    this.controls.addEventListener('change', this.moved);
    this.over.style.touchAction = 'pan-y';
    this.listen();
    this.resize();
    this.fit();
    this.observer = new ResizeObserver(() => {
      this.resize();
      this.moved();
    });
    this.observer.observe(root);
    events.painter(this.painter.name);
  }

  paint(colours: PathColours): void {
    this.colours = colours;
    this.painter.paint(colours);
    this.draw();
  }

  judge(kinds: Uint8Array): void {
    this.data = { ends: this.data.ends, kinds };
    this.cuts = drawn(this.data, cutting);
    this.painter.load(this.data);
  }

  mark(selected: number | null): void {
    this.selected = selected;
    this.later();
  }

  /** All of the path in view, from a side or from where it is seen now. */
  fit(side?: Side): void {
    const { centre, radius } = this.bounds;
    const target = new Vector3(centre.x, centre.y, centre.z);
    const away = side || this.places === null ? new Vector3(...from[side ?? 'corner']) : this.camera.position.clone().sub(this.controls.target);
    this.controls.target.copy(target);
    this.camera.position.copy(target).add(away.normalize().multiplyScalar(4 * radius));
    this.camera.near = 0.1 * radius;
    this.camera.far = 10 * radius;
    this.camera.zoom = 1;
    this.frame();
    this.controls.update(); // looks at the target
    this.zoomToFill();
    this.moved();
  }

  key(name: string): boolean {
    if (name === 'ArrowLeft') this.turn(-turnByKey, 0);
    else if (name === 'ArrowRight') this.turn(turnByKey, 0);
    else if (name === 'ArrowUp') this.turn(0, -turnByKey);
    else if (name === 'ArrowDown') this.turn(0, turnByKey);
    else if (name === '+' || name === '=') this.zoom(zoomByKey);
    else if (name === '-') this.zoom(1 / zoomByKey);
    else if (name === '0') this.fit();
    else return false;
    return true;
  }

  dispose(): void {
    cancelAnimationFrame(this.due);
    this.observer.disconnect();
    this.controls.dispose();
    this.painter.dispose();
    this.root.replaceChildren();
  }

  private listen(): void {
    const at = (event: PointerEvent): [number, number] => [event.offsetX, event.offsetY];
    this.over.addEventListener('pointerdown', (event) => {
      this.pressed = at(event);
      this.controls.enableZoom = true;
    });
    this.over.addEventListener('pointerup', (event) => {
      const [x, y] = at(event);
      const near = this.pressed !== null && Math.hypot(x - this.pressed[0], y - this.pressed[1]) < still;
      this.pressed = null;
      const index = near ? this.under(x, y) : null;
      if (index !== null) this.events.picked(index);
    });
    this.over.addEventListener('pointermove', (event) => {
      if (this.pressed === null && event.pointerType === 'mouse') this.hover(this.under(...at(event)));
    });
    this.over.addEventListener('pointerleave', () => {
      this.controls.enableZoom = false;
      this.hover(null);
    });
  }

  private hover(index: number | null): void {
    if (index === this.hovered) return;
    this.hovered = index;
    this.over.style.cursor = index === null ? 'grab' : 'pointer';
    this.events.hovered(index);
    this.later();
  }

  private under(x: number, y: number): number | null {
    return pick(this.projected(), this.cuts, x, y);
  }

  private matrix(): Matrix4 {
    this.camera.updateMatrixWorld();
    return new Matrix4().multiplyMatrices(this.camera.projectionMatrix, this.camera.matrixWorldInverse);
  }

  private projected(): Float32Array {
    this.places ??= project(this.data.ends, this.matrix().elements, ...this.size);
    return this.places;
  }

  private readonly moved = (): void => {
    this.places = null;
    this.later();
  };

  /** WebGL went away: the plane canvas draws on. */
  private readonly lost = (event: Event): void => {
    event.preventDefault();
    const plane = canvasPainter(this.data);
    this.painter.canvas.replaceWith(plane.canvas);
    this.painter = plane;
    if (this.colours !== null) plane.paint(this.colours);
    this.resize();
    this.events.painter(plane.name);
    this.later();
  };

  private resize(): void {
    this.size = [Math.max(1, this.root.clientWidth), Math.max(1, this.root.clientHeight)];
    const ratio = Math.min(2, window.devicePixelRatio);
    this.painter.resize(...this.size, ratio);
    this.over.width = Math.round(this.size[0] * ratio);
    this.over.height = Math.round(this.size[1] * ratio);
    this.frame();
  }

  /** The camera's box: a millimetre is as long across as it is high. */
  private frame(): void {
    const [width, height] = this.size;
    const half = this.bounds.radius / Math.min(width, height);
    Object.assign(this.camera, { left: -half * width, right: half * width, top: half * height, bottom: -half * height });
    this.camera.updateProjectionMatrix();
  }

  /** A flat path is smaller than the sphere around it. */
  private zoomToFill(): void {
    const { low, high, radius } = this.bounds;
    const corners = [low.x - 0.2 * radius, high.x].flatMap((x) => [low.y - 0.2 * radius, high.y].flatMap((y) => [low.z, high.z].flatMap((z) => [x, y, z])));
    const at = project(Float32Array.from(corners), this.matrix().elements, 2, 2);
    let most = 0;
    for (let k = 0; k < at.length; k += 3) most = Math.max(most, Math.abs(at[k]! - 1), Math.abs(at[k + 1]! - 1));
    if (most > 0) this.zoom(0.9 / most);
  }

  private zoom(factor: number): void {
    this.camera.zoom *= factor;
    this.camera.updateProjectionMatrix();
    this.moved();
  }

  private turn(around: number, down: number): void {
    const way = this.camera.position.clone().sub(this.controls.target);
    const length = way.length();
    const azimuth = Math.atan2(way.y, way.x) + around;
    const polar = Math.min(Math.PI - 1e-3, Math.max(1e-3, Math.acos(way.z / length) + down));
    way.set(Math.sin(polar) * Math.cos(azimuth), Math.sin(polar) * Math.sin(azimuth), Math.cos(polar)).multiplyScalar(length);
    this.camera.position.copy(this.controls.target).add(way);
    this.controls.update();
    this.moved();
  }

  private later(): void {
    cancelAnimationFrame(this.due);
    this.due = requestAnimationFrame(() => this.draw());
  }

  private draw(): void {
    if (this.colours === null) return;
    const places = this.projected();
    this.painter.draw(this.camera, places);
    const context = this.over.getContext('2d')!;
    const ratio = this.over.width / this.size[0];
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, ...this.size);
    drawAxes(context, this.bounds, this.matrix(), this.size, this.colours);
    if (this.hovered !== null) drawMark(context, places, this.hovered, false, this.colours);
    if (this.selected !== null) drawMark(context, places, this.selected, true, this.colours);
  }
}

const open: OpenPath = (root, data, events) => new PathScene(root, data, events);
window.robomillPath = open;
