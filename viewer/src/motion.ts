import * as THREE from "three";
import type { Keyframe, Motion, Triple } from "./head";

/// Translation and angle at a time: linear between key-frames, constant before the first and after the last.
export function interpolate(keyframes: Keyframe[], time: number): { translate: Triple; angle: number } {
  if (keyframes.length === 0) return { translate: [0, 0, 0], angle: 0 };
  const after = keyframes.findIndex((key) => key.time > time);
  if (after === 0) return keyframes[0];
  if (after < 0) return keyframes[keyframes.length - 1];
  const a = keyframes[after - 1];
  const b = keyframes[after];
  const share = (time - a.time) / (b.time - a.time);
  return {
    translate: a.translate.map((x, i) => x + share * (b.translate[i] - x)) as Triple,
    angle: a.angle + share * (b.angle - a.angle),
  };
}

/// The rigid map of a motion at a time: a turn about the axis through the centre, then a shift.
export function rigidMap(motion: Motion | undefined, time: number): THREE.Matrix4 {
  const { translate, angle } = interpolate(motion?.keyframes ?? [], time);
  const shift = new THREE.Vector3(...translate);
  if (!motion || angle === 0) return new THREE.Matrix4().setPosition(shift);
  const turn = new THREE.Matrix4().makeRotationAxis(new THREE.Vector3(...motion.axis).normalize(), angle);
  const centre = new THREE.Vector3(...motion.centre);
  return turn.setPosition(shift.add(centre).sub(centre.clone().applyMatrix4(turn)));
}
