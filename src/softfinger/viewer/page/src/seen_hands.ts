import { DirectionalLight, HemisphereLight, MeshBasicMaterial, MeshStandardMaterial, type Object3D, Scene } from "three";
import { CapsuleHands } from "./capsule_hands";
import { palette } from "./palette";
import { SkinnedHand } from "./skinned_hand";
import type { SeenHand, Side } from "./xr_hand";

/** Depth first: of skin that overlaps itself only the outermost is drawn, so that it is one. */
const kSkin = [
  new MeshBasicMaterial({ colorWrite: false }),
  new MeshStandardMaterial({
    color: palette.skin, roughness: 0.6, emissive: "#9a4630", emissiveIntensity: 0.2, transparent: true, opacity: 0.72,
  }),
];

/** Hands as a headset sees them, in skin: as models, and as capsules where a model has not come. */
export class SeenHands {
  readonly scene = new Scene();
  private readonly capsules = new CapsuleHands(kSkin);
  private readonly models = new Map<Side, SkinnedHand>();
  private readonly asked = new Set<Side>();

  constructor() {
    const key = new DirectionalLight("#fff4e6", 1.6);
    key.position.set(-0.4, 1, 0.5);
    this.scene.add(new HemisphereLight("#e9f1ff", "#b5a9a4", 1.7), key);
    this.add(this.capsules.meshes);
  }

  /** Fetches the models that are not there yet. */
  load(): void {
    for (const side of ["left", "right"] as const) {
      if (this.asked.has(side)) continue;
      this.asked.add(side);
      SkinnedHand.load(side, kSkin).then((model) => {
        this.models.set(side, model);
        this.add(model.meshes);
      }, () => this.asked.delete(side)); // capsules stand in
    }
  }

  show(hands: SeenHand[]): void {
    const without = hands.filter(({ side }) => !this.models.has(side));
    this.capsules.show(without);
    for (const mesh of this.capsules.meshes) mesh.visible = without.length > 0;
    let stumps = 0;
    for (const [side, model] of this.models) {
      const hand = hands.find((seen) => seen.side === side);
      for (const mesh of model.meshes) mesh.visible = hand !== undefined;
      if (hand) stumps += model.pose(hand);
    }
    const kind = (side: Side) => (this.models.has(side) ? "model" : "capsules");
    document.body.dataset.hands = hands.map(({ side }) => `${side} ${kind(side)}`).join(", ");
    document.body.dataset.stumps = String(stumps);
  }

  private add(meshes: Object3D[]): void {
    meshes.forEach((mesh, order) => {
      mesh.renderOrder = order;
      mesh.frustumCulled = false;
    });
    this.scene.add(...meshes);
  }
}
