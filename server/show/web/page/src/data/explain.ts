// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// The life of a thing, as the server tells it (`coslam explain`).

export interface Entry { t_s: number; text: string }

export interface Life {
  entries: Entry[];
  notes: string[];
  covariance: number[] | undefined;  // xx xy xz yy yz zz in the map's frame
}

const NUMBER = String.raw`[-+]?(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?`;
const LINE = /^\s*(-?\d+(?:\.\d+)?) s {1,3}(\S.*)$/;
const COVARIANCE = new RegExp(String.raw`covariance[^-+\d]*((?:${NUMBER}[,;\s)]*){6})`, "i");

export function parseLife(text: string): Life {
  const life: Life = { entries: [], notes: [], covariance: undefined };
  const given = COVARIANCE.exec(text)?.[1]?.match(new RegExp(NUMBER, "gi"))?.map(Number);
  if (given?.length === 6 && given.every(Number.isFinite)) life.covariance = given;
  for (const line of text.split("\n").slice(1)) {
    const entry = LINE.exec(line);
    if (entry) life.entries.push({ t_s: Number(entry[1]), text: entry[2]! });
    else if (line.trim() !== "" && !/^covariance\b/i.test(line)) life.notes.push(line.trim());
  }
  return life;
}

// Throws an Error that says why there is no answer.
export async function fetchLife(kind: string, id: string, token: string | null, signal: AbortSignal): Promise<Life> {
  const query = new URLSearchParams({ kind, id, ...(token === null ? {} : { token }) });
  const response = await fetch(`api/v1/explain?${query.toString()}`, { signal });
  const text = await response.text();
  if (!response.ok) throw new Error(text.trim().split("\n")[0] || `the server answered ${response.status}`);
  return parseLife(text);
}
