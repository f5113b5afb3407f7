#include "core/model/channel_path.hpp"

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

}  // namespace fieldcast
