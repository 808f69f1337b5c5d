import { CanvasTexture, LinearFilter, Sprite, SpriteMaterial } from "three";

const kSize = [256, 96] as const; // px of the drawing
const kScale = 0.042; // of the height of the view
const kColors: Record<string, string> = { touching: "#35d0bf", warning: "#f2b84b", fault: "#ff8a84" }; // by tone

/** A finger's name and its device's state over its nail, always as large. */
export class FingerLabel {
  readonly sprite: Sprite;
  private readonly canvas = document.createElement("canvas");
  private readonly texture = new CanvasTexture(this.canvas);
  private written = "";

  constructor(private readonly name: string, private readonly color: string) {
    [this.canvas.width, this.canvas.height] = kSize;
    this.texture.minFilter = LinearFilter;
    this.texture.generateMipmaps = false;
    this.sprite = new Sprite(new SpriteMaterial({
      map: this.texture, depthTest: false, depthWrite: false, transparent: true, sizeAttenuation: false, toneMapped: false,
    }));
    this.sprite.center.set(0.5, 0);
    this.sprite.scale.set((kScale * kSize[0]) / kSize[1], kScale, 1);
    this.sprite.position.set(-3, 0, 9); // mm in F: over the nail
    this.sprite.renderOrder = 9;
  }

  write(state: string, tone: string, marked: boolean): void {
    const text = `${state}${marked ? " ⚠" : ""}`;
    if (text === this.written) return;
    this.written = text;
    const context = this.canvas.getContext("2d")!;
    const [width, height] = kSize;
    context.clearRect(0, 0, width, height);
    context.font = "600 32px Inter Variable, sans-serif";
    const wide = 20 + Math.max(context.measureText(this.name).width + 26, 0.82 * context.measureText(text).width);
    context.fillStyle = "#0b0e13d9";
    context.beginPath();
    context.roundRect((width - wide) / 2, 2, wide, height - 4, 14);
    context.fill();
    context.fillStyle = this.color;
    context.beginPath();
    context.roundRect((width - context.measureText(this.name).width) / 2 - 16, 19, 16, 16, 4);
    context.fill();
    context.textAlign = "center";
    context.fillStyle = "#e8edf4";
    context.fillText(this.name, width / 2 + 8, 38);
    context.font = "500 26px Inter Variable, sans-serif";
    context.fillStyle = marked ? "#f2b84b" : kColors[tone] ?? "#97a3b4";
    context.fillText(text, width / 2, 76);
    this.texture.needsUpdate = true;
  }

  dispose(): void {
    this.texture.dispose();
    this.sprite.material.dispose();
  }
}
