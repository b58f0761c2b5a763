/** Transforms between coordinate frames, as geometry_msgs describes them. */

export interface Vector {
  readonly x: number;
  readonly y: number;
  readonly z: number;
}

export interface Quaternion extends Vector {
  readonly w: number;
}

/** Where a frame is in another one, and how it is turned. */
export interface Transform {
  readonly translation: Vector;
  readonly rotation: Quaternion;
}

/** A geometry_msgs/TransformStamped. */
export interface TransformStamped {
  readonly header: { readonly stamp: { secs: number; nsecs: number }; readonly frame_id: string };
  readonly child_frame_id: string;
  readonly transform: Transform;
}

export const IDENTITY: Transform = {
  translation: { x: 0, y: 0, z: 0 },
  rotation: { x: 0, y: 0, z: 0, w: 1 },
};

/** A transform with a rotation of length 1; one of length 0, which is common, is none. */
export function unit({ translation, rotation: { x, y, z, w } }: Transform): Transform {
  const length = Math.hypot(x, y, z, w);
  // A message may have numbers that are not finite.
  if (!(length > 0 && length < Infinity)) return { translation, rotation: IDENTITY.rotation };
  return { translation, rotation: { x: x / length, y: y / length, z: z / length, w: w / length } };
}

export function multiplied(a: Transform, b: Transform): Transform {
  const moved = rotated(a.rotation, b.translation);
  const { x, y, z } = a.translation;
  return {
    translation: { x: x + moved.x, y: y + moved.y, z: z + moved.z },
    rotation: product(a.rotation, b.rotation),
  };
}

export function inverse({ translation, rotation }: Transform): Transform {
  const back = { x: -rotation.x, y: -rotation.y, z: -rotation.z, w: rotation.w };
  const { x, y, z } = rotated(back, translation);
  return { translation: { x: -x, y: -y, z: -z }, rotation: back };
}

export function product(a: Quaternion, b: Quaternion): Quaternion {
  return {
    x: a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
    y: a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
    z: a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w,
    w: a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z,
  };
}

export function rotated({ x: i, y: j, z: k, w }: Quaternion, { x, y, z }: Vector): Vector {
  // v + 2w(q × v) + 2q × (q × v)
  const a = 2 * (j * z - k * y);
  const b = 2 * (k * x - i * z);
  const c = 2 * (i * y - j * x);
  return {
    x: x + w * a + j * c - k * b,
    y: y + w * b + k * a - i * c,
    z: z + w * c + i * b - j * a,
  };
}

/** Where a point of a frame is in the frame that its transform leads to. */
export function applied({ translation, rotation }: Transform, point: Vector): Vector {
  const { x, y, z } = rotated(rotation, point);
  return { x: x + translation.x, y: y + translation.y, z: z + translation.z };
}

/** The rotation about z by an angle in radians. */
export function turned(yaw: number): Quaternion {
  return { x: 0, y: 0, z: Math.sin(yaw / 2), w: Math.cos(yaw / 2) };
}

/** The transform between two, at a ratio from 0 to 1; rotations take the shorter way. */
export function between(a: Transform, b: Transform, ratio: number): Transform {
  const rest = 1 - ratio;
  const [from, to] = [a.translation, b.translation];
  const { x, y, z, w } = a.rotation;
  const q = b.rotation;
  const cosine = x * q.x + y * q.y + z * q.z + w * q.w;
  const angle = Math.acos(Math.min(1, Math.abs(cosine)));
  const sine = Math.sin(angle);
  // Of two that are almost equal, the straight line.
  const k = sine < 1e-6 ? rest : Math.sin(rest * angle) / sine;
  const l = (sine < 1e-6 ? ratio : Math.sin(ratio * angle) / sine) * (cosine < 0 ? -1 : 1);
  return {
    translation: {
      x: from.x * rest + to.x * ratio,
      y: from.y * rest + to.y * ratio,
      z: from.z * rest + to.z * ratio,
    },
    rotation: {
      x: x * k + q.x * l,
      y: y * k + q.y * l,
      z: z * k + q.z * l,
      w: w * k + q.w * l,
    },
  };
}

/** Roll, pitch and yaw of a rotation in radians: about the fixed axes x, y and z (REP 103). */
export function rollPitchYaw({
  x,
  y,
  z,
  w,
}: Quaternion): [roll: number, pitch: number, yaw: number] {
  const sine = Math.max(-1, Math.min(1, 2 * (w * y - z * x)));
  return [
    Math.atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y)),
    Math.asin(sine),
    Math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z)),
  ];
}
