// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// Covariances as ROS has them.
const UNKNOWN_VARIANCE = 1e5;  // servers send 1e6 for what they do not know

export function isKnown(covariance: ArrayLike<number> | undefined): covariance is ArrayLike<number> {
  return covariance !== undefined && covariance[0]! > 0 && covariance[0]! < UNKNOWN_VARIANCE;
}

// The position part, xx xy xz yy yz zz.
export function positionCovariance(of: ArrayLike<number>): number[] {
  return [0, 1, 2, 7, 8, 14].map((i) => of[i]!);
}
