// A headset for those who have none, with ?emulate-headset: its right hand follows the pointer.

const kPerPixel = 2e-4; // m
const kPerWheel = 2e-5; // m a unit of the wheel
const kHand = { x: 0, y: 1.54, z: -0.34 }; // m, in the room
const kFieldOfView = 0.5; // rad: near enough to see a finger

/** Takes the place of any headset there is. Escape leaves it, P pinches with the left hand. */
export async function emulateHeadset(): Promise<void> {
  const { XRDevice, XRReferenceSpace: EmulatedSpace, metaQuest3 } = await import("iwer");
  // iwer 2.5.0 wants a matrix where WebXR has a rigid transform.
  const offset = EmulatedSpace.prototype.getOffsetReferenceSpace as unknown as
    (this: XRReferenceSpace, matrix: Float32Array) => XRReferenceSpace;
  Object.assign(EmulatedSpace.prototype, {
    getOffsetReferenceSpace(this: XRReferenceSpace, origin: XRRigidTransform) {
      return offset.call(this, origin.matrix);
    },
  });
  const device = new XRDevice(metaQuest3, { fovy: kFieldOfView, visibilityMask: null });
  device.installRuntime({ forceInstall: true });
  device.primaryInputMode = "hand";
  device.canvasContainer.style.background = "#0b0e13";
  const { right, left } = device.hands;
  if (!right || !left) return;
  const at = { ...kHand };
  const move = () => right.position.set(at.x, at.y, at.z);
  left.position.set(kHand.x - 0.3, kHand.y, kHand.z);
  move();

  const active = () => device.activeSession !== undefined;
  window.addEventListener("pointermove", (event) => {
    if (!active()) return;
    at.x += kPerPixel * event.movementX;
    at.y -= kPerPixel * event.movementY;
    move();
  }, { capture: true });
  window.addEventListener("wheel", (event) => {
    if (!active()) return;
    at.z += kPerWheel * event.deltaY;
    move();
    event.preventDefault();
  }, { capture: true, passive: false });
  window.addEventListener("keydown", (event) => {
    if (!active()) return;
    if (event.key === "Escape") void device.activeSession?.end();
    if (event.key.toLowerCase() === "p") left.updatePinchValue(1);
  });
  window.addEventListener("keyup", (event) => {
    if (event.key.toLowerCase() === "p") left.updatePinchValue(0);
  });
}
