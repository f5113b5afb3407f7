// Converts typed text to a value of a channel's type. Pure.

export type Typed = { value: string | number | boolean | bigint } | { fault: 'number' | 'range' };

const integerBits: Record<string, number> = { int8: 8, int16: 16, int32: 32, int64: 64, uint8: 8, uint16: 16, uint32: 32, uint64: 64 };

// `limits`: write-min and write-max, if they are set. A scaled integer may have decimals; the bridge applies the scale.
export function typedValue(text: string, type: string, limits: Record<string, number>): Typed {
  if (type.startsWith('string')) return { value: text };
  if (type === 'bool') return { value: text === 'true' };
  const trimmed = text.trim().replace(',', '.');
  if (!/^[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?$/i.test(trimmed)) return { fault: 'number' };
  const number = Number(trimmed);
  if (!Number.isFinite(number)) return { fault: 'number' };
  const low = limits['write-min'], high = limits['write-max'];
  if ((low !== undefined && number < low) || (high !== undefined && number > high)) return { fault: 'range' };
  const exact = integerBits[type] === 64 && /^[+-]?\d+$/.test(trimmed) && !Number.isSafeInteger(number);
  return { value: exact ? BigInt(trimmed) : number };
}
