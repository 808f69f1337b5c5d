import {
  ACESFilmicToneMapping, DirectionalLight, HemisphereLight, PerspectiveCamera, PMREMGenerator, Raycaster, Scene,
  Spherical, Vector2, Vector3, WebGLRenderer,
} from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { RoomEnvironment } from "three/addons/environments/RoomEnvironment.js";
import { turnByKeys } from "./turning";

// From the finger's right, a little from the tip and from below, so that the pad is seen.
export const kHome = new Vector3(0.5, -1.0, -0.56).normalize();
/** From before the tips and below, so that fingers beside each other are beside each other. */
export const kBeforeTips = new Vector3(1.0, -0.42, -0.4).normalize();

export interface ViewOptions {
  pane: HTMLElement;
  distance: number; // mm
  target: Vector3;
  from?: Vector3; // the direction it is seen from, kHome where none is given
}

/** One pane: its scene, camera and orbit controls. */
export class View {
  readonly scene = new Scene();
  readonly camera = new PerspectiveCamera(30, 1, 1, 2000);
  readonly controls: OrbitControls;
  readonly pane: HTMLElement;
  private home: ViewOptions;

  constructor(options: ViewOptions) {
    this.home = options;
    this.pane = options.pane;
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, options.pane);
    this.controls.enableDamping = true;
    this.controls.dampingFactor = 0.12;
    this.controls.enablePan = false;
    this.controls.minDistance = 25;
    this.controls.maxDistance = 400;
    this.scene.add(new HemisphereLight("#e9f1ff", "#6b5a54", 1.1));
    const key = new DirectionalLight("#fff4e6", 1.9);
    key.position.set(60, -90, 110);
    const fill = new DirectionalLight("#9cc2ff", 1.1);
    fill.position.set(40, -60, -110);
    const back = new DirectionalLight("#ffffff", 0.9);
    back.position.set(-120, 110, 30);
    this.scene.add(key, fill, back);
    this.reset();
  }

  reset(): void {
    this.controls.target.copy(this.home.target);
    this.camera.position.copy(this.home.target).addScaledVector(this.home.from ?? kHome, this.home.distance);
    this.controls.update();
  }
  /** Puts home elsewhere, and the eye there along the direction it looks in now; or along `from`, where that is new. */
  frame(target: Vector3, distance: number, from: Vector3 = this.home.from ?? kHome): void {
    const turned = from !== (this.home.from ?? kHome);
    if (!turned && this.home.target.distanceTo(target) < 1 && Math.abs(this.home.distance - distance) < 2) return;
    const direction = turned ? from : this.camera.position.clone().sub(this.controls.target).normalize();
    this.home = { ...this.home, target: target.clone(), distance, from };
    this.controls.target.copy(target);
    this.camera.position.copy(target).addScaledVector(direction, distance);
    this.controls.update();
  }
  /** Keeps a moving thing in the middle without turning the view. */
  follow(point: Vector3, share: number): void {
    const shift = point.clone().sub(this.controls.target);
    if (shift.lengthSq() < 1e-4) return;
    shift.multiplyScalar(share);
    this.controls.target.add(shift);
    this.camera.position.add(shift);
  }
  /** The ray from the eye through the pointer. */
  under({ clientX, clientY }: PointerEvent): Raycaster {
    const box = this.pane.getBoundingClientRect();
    const raycaster = new Raycaster();
    raycaster.setFromCamera(
      new Vector2((2 * (clientX - box.left)) / box.width - 1, 1 - (2 * (clientY - box.top)) / box.height), this.camera);
    return raycaster;
  }
  /** Direction to the eye, as angles about the target. */
  angles(): Spherical {
    return new Spherical().setFromVector3(toYUp(this.camera.position.clone().sub(this.controls.target)));
  }
  /** Puts the eye there and tells whoever turns with this view. */
  lookFrom(angles: Spherical): void {
    angles.radius = Math.min(Math.max(angles.radius, this.controls.minDistance), this.controls.maxDistance);
    this.camera.position.copy(this.controls.target).add(toZUp(new Vector3().setFromSpherical(angles)));
    this.controls.update();
  }
  turnTo(angles: Spherical): void {
    const own = this.angles();
    own.theta = angles.theta;
    own.phi = angles.phi;
    this.camera.position.copy(this.controls.target).add(toZUp(new Vector3().setFromSpherical(own)));
    this.camera.lookAt(this.controls.target);
  }
}

/** One WebGL canvas behind both panes; turning one view turns the other. */
export class Stage {
  /** Drawn without graphics hardware, by the processor that also simulates: plainer and seldomer. */
  readonly isPlain = isPlain();
  readonly renderer: WebGLRenderer;
  private changed = true;

  constructor(private readonly canvas: HTMLCanvasElement, readonly views: View[]) {
    this.renderer = new WebGLRenderer({ canvas, antialias: !this.isPlain, alpha: true });
    this.renderer.toneMapping = ACESFilmicToneMapping;
    this.renderer.toneMappingExposure = 1.05;
    this.renderer.setPixelRatio(this.isPlain ? 1 : Math.min(window.devicePixelRatio, 2));
    this.renderer.setScissorTest(true);
    if (!this.isPlain) this.addReflections();
    for (const view of views) {
      view.controls.addEventListener("change", () => this.link(view));
      view.pane.addEventListener("dblclick", () => this.reset());
      turnByKeys(view, () => this.reset());
    }
    new ResizeObserver(() => this.resize()).observe(canvas);
    this.renderer.xr.addEventListener("sessionend", () => this.resize());
    this.resize();
  }

  reset(): void {
    for (const view of this.views) view.reset();
  }

  /** Calls `frame` for every picture, with the frame of the headset where one is worn. */
  animate(frame: (now: number, headset: XRFrame | undefined) => void): void {
    this.renderer.setAnimationLoop(frame);
  }

  /** Says that a scene is to be drawn again; turned views and a new size are noticed here. */
  touch(): void {
    this.changed = true;
  }

  /** Draws where anything has changed. */
  render(): void {
    for (const view of this.views) view.controls.update();
    if (!this.changed) return;
    this.changed = false;
    const whole = this.canvas.getBoundingClientRect();
    for (const view of this.views) {
      const box = view.pane.getBoundingClientRect();
      if (box.width < 1 || box.height < 1) continue;
      const left = box.left - whole.left;
      const bottom = whole.bottom - box.bottom;
      view.camera.aspect = box.width / box.height;
      // Narrow panes step back, so that the whole finger stays in sight.
      view.camera.fov = view.camera.aspect < 1.15 ? 30 * Math.min(1.9, 1.15 / view.camera.aspect) : 30;
      view.camera.updateProjectionMatrix();
      this.renderer.setViewport(left, bottom, box.width, box.height);
      this.renderer.setScissor(left, bottom, box.width, box.height);
      this.renderer.render(view.scene, view.camera);
    }
  }

  private addReflections(): void {
    const generator = new PMREMGenerator(this.renderer);
    const room = generator.fromScene(new RoomEnvironment(), 0.04).texture;
    for (const { scene } of this.views) {
      scene.environment = room;
      scene.environmentIntensity = 0.35;
    }
    generator.dispose();
  }

  private link(turned: View): void {
    this.changed = true;
    const angles = turned.angles();
    for (const view of this.views) if (view !== turned) view.turnTo(angles);
  }

  private resize(): void {
    if (this.renderer.xr.isPresenting) return; // the headset's size is its own
    const { clientWidth, clientHeight } = this.canvas;
    this.renderer.setSize(Math.max(clientWidth, 1), Math.max(clientHeight, 1), false);
    this.changed = true;
  }
}

const toYUp = (v: Vector3) => v.set(v.x, v.z, -v.y);
const toZUp = (v: Vector3) => v.set(v.x, -v.z, v.y);

/** Whether WebGL has no hardware here; ?quality=high and ?quality=plain overrule. */
function isPlain(): boolean {
  const wanted = new URLSearchParams(location.search).get("quality");
  if (wanted) return wanted === "plain";
  const gl = document.createElement("canvas").getContext("webgl");
  const info = gl?.getExtension("WEBGL_debug_renderer_info");
  const name = gl && info ? String(gl.getParameter(info.UNMASKED_RENDERER_WEBGL)) : "";
  gl?.getExtension("WEBGL_lose_context")?.loseContext();
  return /swiftshader|llvmpipe|software/i.test(name);
}
