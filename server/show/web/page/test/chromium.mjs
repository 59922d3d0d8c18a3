// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
export const CHROMIUM = process.env.COSLAM_CHROMIUM ?? "/usr/bin/chromium";
