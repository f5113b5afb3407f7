#include "tools/cli/text/character_width.hpp"

#include <locale.h>
#include <wchar.h>

namespace fieldcast::cli {
namespace {

locale_t unicode_locale() {
  static const locale_t locale = ::newlocale(LC_CTYPE_MASK, "C.UTF-8", nullptr);
  return locale;
}

}  // namespace

WidthsOfUnicode::WidthsOfUnicode() : before_(::uselocale(unicode_locale())) {}
WidthsOfUnicode::~WidthsOfUnicode() { ::uselocale(static_cast<locale_t>(before_)); }

int WidthsOfUnicode::of(char32_t c) const { return ::wcwidth(static_cast<wchar_t>(c)); }

}  // namespace fieldcast::cli
