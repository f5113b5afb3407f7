// The channels of a device: a vector whose copies share their elements until one of them changes,
// because a bridge keeps several copies of its configuration and almost never changes one.
#pragma once

#include <cstddef>
#include <initializer_list>
#include <memory>
#include <utility>
#include <vector>

#include "core/model/channel_spec.hpp"

namespace fieldcast {

// As with std::vector, several threads may read one list, and its copies are independent. Each
// non-const access makes the elements its own first, so it ends references into them. A copy made
// later ends them too: a reference for changes must not outlive it.
class ChannelList {
 public:
  using value_type = ChannelSpec;
  using iterator = std::vector<ChannelSpec>::iterator;
  using const_iterator = std::vector<ChannelSpec>::const_iterator;

  ChannelList() = default;
  ChannelList(std::vector<ChannelSpec> channels)
      : channels_(std::make_shared<std::vector<ChannelSpec>>(std::move(channels))) {}
  ChannelList(std::initializer_list<ChannelSpec> channels)
      : ChannelList(std::vector<ChannelSpec>(channels)) {}

  [[nodiscard]] std::size_t size() const { return all().size(); }
  [[nodiscard]] bool empty() const { return all().empty(); }
  [[nodiscard]] const ChannelSpec& operator[](std::size_t index) const { return all()[index]; }
  [[nodiscard]] const ChannelSpec& at(std::size_t index) const { return all().at(index); }
  [[nodiscard]] const ChannelSpec& front() const { return all().front(); }
  [[nodiscard]] const ChannelSpec& back() const { return all().back(); }
  [[nodiscard]] const_iterator begin() const { return all().begin(); }
  [[nodiscard]] const_iterator end() const { return all().end(); }

  [[nodiscard]] ChannelSpec& operator[](std::size_t index) { return own()[index]; }
  [[nodiscard]] ChannelSpec& front() { return own().front(); }
  [[nodiscard]] ChannelSpec& back() { return own().back(); }
  [[nodiscard]] iterator begin() { return own().begin(); }
  [[nodiscard]] iterator end() { return own().end(); }
  void push_back(ChannelSpec channel) { own().push_back(std::move(channel)); }
  ChannelSpec& emplace_back() { return own().emplace_back(); }
  void resize(std::size_t count) { own().resize(count); }
  void reserve(std::size_t count) { own().reserve(count); }
  void clear() { channels_.reset(); }
  // The elements as a vector, for every other change.
  [[nodiscard]] std::vector<ChannelSpec>& own() {
    if (channels_.use_count() != 1)
      channels_ = std::make_shared<std::vector<ChannelSpec>>(std::as_const(*this).all());
    return *channels_;
  }

  friend bool operator==(const ChannelList& a, const ChannelList& b) {
    return a.channels_ == b.channels_ || a.all() == b.all();
  }

 private:
  [[nodiscard]] const std::vector<ChannelSpec>& all() const {
    static const std::vector<ChannelSpec> none;
    return channels_ ? *channels_ : none;
  }

  std::shared_ptr<std::vector<ChannelSpec>> channels_;
};

}  // namespace fieldcast
