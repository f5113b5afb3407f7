#include "bridge/bus/iconv_codec.hpp"

#include <iconv.h>

#include "core/base/message_text.hpp"

namespace fieldcast {
namespace {

const iconv_t kNone = reinterpret_cast<iconv_t>(-1);

// As PLCs and their panels use them: CP932 is the Shift-JIS of Japanese Windows.
const char* name_of(Charset charset) { return charset == Charset::kGbk ? "GBK" : "CP932"; }

}  // namespace

class IconvCodec::Conversion {
 public:
  Conversion(const char* to, const char* from) : handle_(iconv_open(to, from)) {}
  ~Conversion() {
    if (open()) iconv_close(handle_);
  }
  Conversion(const Conversion&) = delete;
  Conversion& operator=(const Conversion&) = delete;
  [[nodiscard]] bool open() const { return handle_ != kNone; }

  // Converts up to the first invalid byte and removes the converted bytes from the front of `text`.
  std::string run(std::string_view& text) {
    iconv(handle_, nullptr, nullptr, nullptr, nullptr);  // resets the conversion state
    std::string out(4 * text.size() + 8, '\0');
    // Required by iconv's signature; it does not write there.
    char* in = const_cast<char*>(text.data());
    char* end = out.data();
    std::size_t left = text.size(), room = out.size();
    iconv(handle_, &in, &left, &end, &room);
    text.remove_prefix(text.size() - left);
    out.resize(out.size() - room);
    return out;
  }

 private:
  iconv_t handle_;
};

IconvCodec::IconvCodec() = default;
IconvCodec::~IconvCodec() = default;

IconvCodec::Conversion* IconvCodec::conversion(Charset charset, bool to_utf8) {
  auto& made = made_[(charset == Charset::kGbk ? 0u : 2u) + (to_utf8 ? 0u : 1u)];
  if (!made)
    made = to_utf8 ? std::make_unique<Conversion>("UTF-8", name_of(charset))
                   : std::make_unique<Conversion>(name_of(charset), "UTF-8");
  return made->open() ? made.get() : nullptr;
}

std::string IconvCodec::to_utf8(Charset charset, std::string_view bytes) {
  const bool table = charset == Charset::kGbk || charset == Charset::kShiftJis;
  Conversion* const conversion = table ? this->conversion(charset, true) : nullptr;
  if (conversion == nullptr) return plain_text_codec().to_utf8(charset, bytes);
  std::string text;
  while (!bytes.empty()) {
    text += escaped(conversion->run(bytes));
    if (bytes.empty()) break;
    // This byte begins no character.
    text += plain_text_codec().to_utf8(charset, bytes.substr(0, 1));
    bytes.remove_prefix(1);
  }
  return text;
}

std::optional<std::string> IconvCodec::from_utf8(Charset charset, std::string_view text) {
  const bool table = charset == Charset::kGbk || charset == Charset::kShiftJis;
  Conversion* const conversion = table ? this->conversion(charset, false) : nullptr;
  if (conversion == nullptr) return plain_text_codec().from_utf8(charset, text);
  std::string bytes = conversion->run(text);
  if (!text.empty()) return std::nullopt;
  return bytes;
}

}  // namespace fieldcast
