// The types of packages.mjs.

declare module 'yaml-parser' {
  export { Parser } from 'yaml';
}
declare module 'yaml-scalar' {
  import type { CST } from 'yaml';
  export function resolveFlowScalar(token: CST.FlowScalar, strict: boolean, onError: () => void): { value: string };
}
