#include "core/model/channel_pattern.hpp"

namespace fieldcast {

tl::expected<ChannelPath, std::string> ChannelPath::parse(std::string_view text) {
  const auto first = text.find('/');
  const auto second = first == std::string_view::npos ? first : text.find('/', first + 1);
  ChannelPath path;
  if (second != std::string_view::npos && text.find('/', second + 1) == std::string_view::npos) {
    path = {std::string(text.substr(0, first)),
            std::string(text.substr(first + 1, second - first - 1)),
            std::string(text.substr(second + 1))};
  }
  if (path.bus.empty() || path.device.empty() || path.channel.empty()) {
    return tl::unexpected("'" + std::string(text) +
                          "' is no channel; write BUS/DEVICE/CHANNEL, for instance "
                          "press-shop/press-1/running");
  }
  return path;
}

bool glob_matches(std::string_view glob, std::string_view text) {
  // After a mismatch only the last star can match one more character; earlier ones cannot help.
  std::size_t g = 0;
  std::size_t t = 0;
  std::size_t star = std::string_view::npos;
  std::size_t resume = 0;
  while (t < text.size()) {
    if (g < glob.size() && glob[g] == '*') {
      star = g++;
      resume = t;
    } else if (g < glob.size() && glob[g] == text[t]) {
      ++g;
      ++t;
    } else if (star != std::string_view::npos) {
      g = star + 1;
      t = ++resume;
    } else {
      return false;
    }
  }
  while (g < glob.size() && glob[g] == '*') ++g;
  return g == glob.size();
}

tl::expected<Pattern, std::string> Pattern::parse(std::string_view text) {
  Pattern pattern;
  if (text.empty()) return pattern;
  std::string_view rest = text;
  for (std::size_t i = 0;; ++i) {
    if (i == pattern.segments_.size()) {
      return tl::unexpected("pattern '" + std::string(text) +
                            "' has more than three segments; write bus/device/channel");
    }
    const auto slash = rest.find('/');
    const auto segment = rest.substr(0, slash);
    if (segment.empty())
      return tl::unexpected("pattern '" + std::string(text) +
                            "' has an empty segment; write * for any");
    pattern.segments_[i] = segment;
    if (slash == std::string_view::npos) return pattern;
    rest.remove_prefix(slash + 1);
  }
}

bool Pattern::matches(std::string_view bus, std::string_view device,
                      std::string_view channel) const {
  return matches(bus, device) && glob_matches(segments_[2], channel);
}

bool Pattern::matches(std::string_view bus, std::string_view device) const {
  return matches(bus) && glob_matches(segments_[1], device);
}

bool Pattern::matches(std::string_view bus) const { return glob_matches(segments_[0], bus); }

std::string Pattern::text() const { return segments_[0] + '/' + segments_[1] + '/' + segments_[2]; }

}  // namespace fieldcast
