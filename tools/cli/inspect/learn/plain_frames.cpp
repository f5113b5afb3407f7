#include "tools/cli/inspect/learn/plain_frames.hpp"

#include <algorithm>

#include "tools/cli/inspect/learn/checksum_search.hpp"

namespace fieldcast::learn {
namespace {

using declared::Escape;

struct Form {
  std::string_view name;
  Escape escape;
  std::size_t marks;  // at the begin of a frame
};
constexpr Form kEscapes[] = {{"dle", Escape::kDle, 2},     {"slip", Escape::kSlip, 1},
                             {"cobs", Escape::kCobs, 0},   {"hdlc", Escape::kHdlc, 1},
                             {"shdlc", Escape::kShdlc, 1}, {"kmp", Escape::kKmp, 1}};

// Empty if the frame has not this form.
std::optional<Bytes> without_escapes(ByteView frame, const Form& form) {
  if (frame.size() < form.marks) return std::nullopt;
  const auto read = declared::unescape(form.escape, frame.subspan(form.marks));
  if (read.invalid || !read.ended) return std::nullopt;
  Bytes plain(frame.begin(), frame.begin() + static_cast<std::ptrdiff_t>(form.marks));
  append(plain, read.plain);
  append(plain, frame.subspan(form.marks + read.used));
  return plain;
}

bool unescape(PlainFrames& frames, const Form& form) {
  Evidence valid;
  for (Exchange& exchange : frames.exchanges) {
    for (Bytes* frame : {&exchange.request, &exchange.response}) {
      if (frame->empty()) continue;
      auto plain = without_escapes(*frame, form);
      valid.add(plain.has_value());
      if (plain) *frame = std::move(*plain);
    }
  }
  frames.escape = form.name;
  return valid.holds_mostly();
}

// FE wakes up a receiver; a driver that changes its direction can make 00 and FF.
void drop_lead(PlainFrames& frames) {
  for (Exchange& exchange : frames.exchanges) {
    Bytes& bytes = exchange.response;
    const auto first = std::ranges::find_if(
        bytes, [](std::uint8_t byte) { return byte != 0xFE && byte != 0xFF && byte != 0x00; });
    if (first == bytes.end() || first == bytes.begin()) continue;
    bytes.erase(bytes.begin(), first);
    frames.lead = true;
  }
}

// Frames that have the checksum of their direction.
std::size_t checked(const PlainFrames& plain) {
  std::size_t count = 0;
  for (const auto side : {&Exchange::request, &Exchange::response}) {
    Frames frames;
    for (const Exchange& exchange : plain.exchanges) frames.emplace_back(exchange.*side);
    const auto found = find_checksum(frames, is_text(frames));
    if (found)
      count += static_cast<std::size_t>(
          std::ranges::count_if(frames, [&](ByteView frame) { return found->fits(frame); }));
  }
  return count;
}

}  // namespace

PlainFrames plain_frames(const std::vector<Exchange>& exchanges) {
  PlainFrames best{.exchanges = exchanges};
  std::size_t most = checked(best);
  const auto consider = [&](PlainFrames&& form) {
    if (form.exchanges == exchanges) return;
    const std::size_t count = checked(form);
    if (count > most) most = count, best = std::move(form);
  };
  PlainFrames awake{.exchanges = exchanges};
  drop_lead(awake);
  consider(std::move(awake));
  for (const Form& form : kEscapes) {
    PlainFrames plain{.exchanges = exchanges};
    if (unescape(plain, form)) consider(std::move(plain));
  }
  return best;
}

}  // namespace fieldcast::learn
