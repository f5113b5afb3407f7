// Makes text from the network safe to show. Marks that change the writing direction or have no width, and control characters except
// ends of lines and tabs, are written in the form \u202E. A name cannot change how the text around it reads. The marks are those
// of is_printable() (core/base/message_text.hpp). Pure.

const unprintable = /[\u0000-\u0008\u000b\u000c\u000e-\u001f\u007f-\u009f\u061c\u200b-\u200f\u2028-\u202e\u2060-\u206f\ufeff]/g;
export const printable = (text: string): string =>
  text.replace(unprintable, (mark) => `\\u${mark.charCodeAt(0).toString(16).toUpperCase().padStart(4, '0')}`);

export function setText(element: Element, received: string): void {
  const text = printable(received);
  if (element.textContent !== text) element.textContent = text;
}
