// Changes valid RTPS datagrams as an attacker would: numbers at their limits, lengths, cuts,
// submessages reordered or mixed from two datagrams, parameters doubled and left out.
#pragma once

#include <random>

#include "tests/bridge/dds/transport/rtps_datagrams.hpp"

namespace fieldcast::testing {

class RtpsMutation {
 public:
  RtpsMutation(std::vector<Datagram> corpus, std::uint64_t seed)
      : corpus_(std::move(corpus)), random_(seed) {}

  Datagram next() {
    Datagram one = any();
    if (below(4) == 0) one = spliced(one, any());
    for (std::size_t changes = 1 + below(3); changes > 0; --changes) change(one);
    return one;
  }

 private:
  std::size_t below(std::size_t end) { return random_() % end; }
  const Datagram& any() { return corpus_[below(corpus_.size())]; }

  static std::vector<std::size_t> submessages(const Datagram& of) {
    std::vector<std::size_t> begins;
    for_each_submessage(of, [&](const SubmessageView& one) {
      begins.push_back(one.begin);
      return true;
    });
    return begins;
  }
  // Joins the start of `first` and the end of `second` at submessage borders.
  Datagram spliced(const Datagram& first, const Datagram& second) {
    const auto of_first = submessages(first), of_second = submessages(second);
    if (of_first.empty() || of_second.empty()) return first;
    const auto end = static_cast<std::ptrdiff_t>(of_first[below(of_first.size())]);
    const auto begin = static_cast<std::ptrdiff_t>(of_second[below(of_second.size())]);
    Datagram all(first.begin(),
                 first.begin() + (below(2) == 0 ? end : std::ptrdiff_t(first.size())));
    all.insert(all.end(), second.begin() + begin, second.end());
    return all;
  }

  void change(Datagram& one) {
    if (one.size() <= kMessageHeader + kSubmessageHeader) return;
    const std::size_t at = kMessageHeader + below(one.size() - kMessageHeader);
    const std::size_t word = std::min(at / 4 * 4, one.size() - 4);
    switch (below(8)) {
      case 0: one[at] ^= static_cast<std::uint8_t>(1U << below(8)); break;
      case 1: one[at] = static_cast<std::uint8_t>(random_()); break;
      case 2: one.resize(at); break;
      case 3: set(one, word, edge()); break;
      case 4: add(one, word); break;
      case 5: insert_or_erase(one, word); break;
      case 6: change_head(one); break;
      default: change_number(one); break;
    }
  }
  std::uint32_t edge() {
    constexpr std::uint32_t kEdges[] = {
        0,      1,       3,        4,       16,       255,        256,        257,       0x7fff,
        0xffff, 0x10000, 0x100000, 1 << 30, 1u << 31, 0x7fffffff, 0xffffffff, 0xfffffffc};
    return kEdges[below(std::size(kEdges))];
  }
  static void set(Datagram& one, std::size_t at, std::uint32_t value) {
    for (std::size_t i = 0; i < 4 && at + i < one.size(); ++i)
      one[at + i] = static_cast<std::uint8_t>(value >> 8 * i);
  }
  void add(Datagram& one, std::size_t at) {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < 4; ++i) value |= std::uint32_t{one[at + i]} << 8 * i;
    set(one, at, value + static_cast<std::uint32_t>(below(9)) - 4);
  }
  void insert_or_erase(Datagram& one, std::size_t at) {
    const auto begin = one.begin() + static_cast<std::ptrdiff_t>(at);
    if (below(2) == 0) {
      one.insert(begin, 4 * (1 + below(8)), static_cast<std::uint8_t>(random_()));
    } else {
      one.erase(begin, std::min(one.end(), begin + 4));
    }
    fit_last(one);
  }
  // Mostly corrects the length of the last submessage to the end of the datagram.
  void fit_last(Datagram& one) {
    const auto begins = submessages(one);
    if (begins.empty() || below(8) == 0) return;
    const std::size_t length = one.size() - begins.back() - kSubmessageHeader;
    one[begins.back() + 2] = static_cast<std::uint8_t>(length);
    one[begins.back() + 3] = static_cast<std::uint8_t>(length >> 8);
  }
  void change_head(Datagram& one) {
    constexpr std::uint8_t kKinds[] = {0x01, 0x06, 0x07, 0x08, 0x09, 0x0c, 0x0d, 0x0e, 0x0f, 0x12,
                                       0x13, 0x15, 0x16, 0x30, 0x31, 0x32, 0x33, 0x34, 0x80};
    const auto begins = submessages(one);
    if (begins.empty()) return;
    const std::size_t at = begins[below(begins.size())];
    if (below(2) == 0)
      one[at] = kKinds[below(std::size(kKinds))];
    else
      one[at + 1] ^= static_cast<std::uint8_t>(1U << below(5));
  }
  // Sets the sequence number of DATA, DATA_FRAG, HEARTBEAT, GAP, .. to a plausible value.
  void change_number(Datagram& one) {
    const auto begins = submessages(one);
    if (begins.empty()) return;
    const std::size_t at = begins[below(begins.size())];
    const bool is_data = one[at] == 0x15 || one[at] == 0x16;
    const std::size_t number = at + kSubmessageHeader + (is_data ? 12 : 8);
    if (number + 8 > one.size()) return;
    set(one, number, 0);
    set(one, number + 4, static_cast<std::uint32_t>(below(5000)));
  }

  std::vector<Datagram> corpus_;
  std::mt19937_64 random_;
};

}  // namespace fieldcast::testing
