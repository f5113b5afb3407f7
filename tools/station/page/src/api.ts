// HTTP requests to the station: JSON in and out, errors with the station's hint.

export class ApiError extends Error {
  constructor(readonly status: number, message: string, readonly hint: string, readonly retryAfter_s = 0, readonly answer: unknown = undefined) {
    super(message);
  }
}

// Throws ApiError; its status is 0 if the station was not reached.
export async function request<T>(path: string, body?: unknown, signal?: AbortSignal): Promise<T> {
  const init: RequestInit = { credentials: 'same-origin' };
  if (signal) init.signal = signal;
  if (body !== undefined) {
    init.method = 'POST';
    init.headers = { 'content-type': 'application/json' };
    init.body = JSON.stringify(body);
  }
  let response: Response;
  try {
    response = await fetch(path, init);
  } catch (error) {
    if (signal?.aborted) throw error;
    throw new ApiError(0, 'unreachable', '');
  }
  if (response.status === 204) return undefined as T;
  const text = await response.text();
  let answer: unknown;
  try {
    answer = JSON.parse(text);
  } catch {
    answer = undefined;
  }
  if (!response.ok) {
    const told = (answer ?? {}) as { error?: string; hint?: string };
    throw new ApiError(response.status, told.error ?? response.statusText, told.hint ?? '', Number(response.headers.get('retry-after')) || 0, answer);
  }
  return answer as T;
}

export function query(path: string, parameters: Record<string, string | number | readonly string[] | undefined>): string {
  const search = new URLSearchParams();
  for (const [name, value] of Object.entries(parameters)) {
    if (value === undefined) continue;
    for (const each of Array.isArray(value) ? value : [value]) search.append(name, String(each));
  }
  return `${path}?${search}`;
}
