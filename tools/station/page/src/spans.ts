// Time ranges that the user can select for a trend.

export const spans = [
  { key: '1min', ms: 60_000 }, { key: '10min', ms: 600_000 }, { key: '1h', ms: 3_600_000 }, { key: '8h', ms: 28_800_000 },
  { key: '1d', ms: 86_400_000 }, { key: '7d', ms: 604_800_000 }, { key: '30d', ms: 2_592_000_000 },
] as const;

export const spanOf = (key: string | null, otherwise: number): number => spans.find((span) => span.key === key)?.ms ?? otherwise;
export const labelOf = (key: string): string => key.replace(/(\d+)/, '$1 ');
