// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
import { App } from "./app";

new App(document.getElementById("app")!).start();
