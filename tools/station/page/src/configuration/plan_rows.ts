// Joins the plans of the draft with those of today by bus. Pure.

import type { BusPlan, Checked } from './api';

export interface PlanRow {
  bus: string;
  today: BusPlan | undefined;
  draft: BusPlan | undefined;
}

// Buses that are not feasible first, then those with a change of load, then by name.
export function planRows({ draft, today }: Pick<Checked, 'draft' | 'today'>): PlanRow[] {
  const names = new Set([...draft, ...today].map(({ bus }) => bus));
  const rows = [...names].map((bus) => ({ bus, today: today.find((each) => each.bus === bus), draft: draft.find((each) => each.bus === bus) }));
  const rank = ({ today: was, draft: is }: PlanRow): number => (is && !is.feasible ? 0 : !was || !is || Math.abs(was.load - is.load) > 0.0005 ? 1 : 2);
  return rows.sort((a, b) => rank(a) - rank(b) || a.bus.localeCompare(b.bus));
}

// The largest gap in relation to the refresh that was asked for.
export const worstOf = (plan: BusPlan | undefined): BusPlan['worst'][number] | undefined =>
  plan?.worst.reduce<BusPlan['worst'][number] | undefined>((worst, each) =>
    !worst || each.gap_ms / each.refresh_ms > worst.gap_ms / worst.refresh_ms ? each : worst, undefined);
