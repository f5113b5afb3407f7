// Addresses: #/page/part/part?name=value. Parts are URL-decoded.

export interface Route {
  name: string;
  parts: string[];
  query: URLSearchParams;
}

export function parseRoute(hash: string): Route {
  const [path = '', search = ''] = hash.replace(/^#\/?/, '').split('?', 2);
  const [name, ...parts] = path.split('/').map((part) => {
    try {
      return decodeURIComponent(part);
    } catch {
      return part;
    }
  });
  return { name: name || 'overview', parts: parts.filter((part) => part !== ''), query: new URLSearchParams(search) };
}

export function link(name: string, parts: readonly string[] = [], query: Record<string, string | readonly string[]> = {}): string {
  const search = new URLSearchParams();
  for (const [key, value] of Object.entries(query))
    for (const each of Array.isArray(value) ? value : [value]) search.append(key, each as string);
  const text = search.toString();
  return `#/${[name, ...parts.map(encodeURIComponent)].join('/')}${text ? `?${text}` : ''}`;
}

export const channelLink = (path: string): string => link('channel', path.split('/'));
