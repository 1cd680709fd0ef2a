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

/// The rigid map of a motion at a time, row by row (3 x 4): a turn about the axis through the centre, then a shift.
export function rigidMap(motion: Motion | undefined, time: number): number[] {
  const { translate, angle } = interpolate(motion?.keyframes ?? [], time);
  if (!motion || angle === 0) return [1, 0, 0, translate[0], 0, 1, 0, translate[1], 0, 0, 1, translate[2]];
  const length = Math.hypot(...motion.axis);
  const [x, y, z] = motion.axis.map((a) => a / length);
  const c = Math.cos(angle);
  const s = Math.sin(angle);
  const d = 1 - c;
  const turn = [
    [c + d * x * x, d * x * y - s * z, d * x * z + s * y],
    [d * x * y + s * z, c + d * y * y, d * y * z - s * x],
    [d * x * z - s * y, d * y * z + s * x, c + d * z * z],
  ];
  return turn.flatMap((row, i) => {
    const turned = row[0] * motion.centre[0] + row[1] * motion.centre[1] + row[2] * motion.centre[2];
    return [...row, motion.centre[i] - turned + translate[i]];
  });
}
