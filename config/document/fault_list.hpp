// Collects the faults of one load, without duplicates, at most kMaxFaults.
#pragma once

#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "config/document/document.hpp"
#include "config/document/fault.hpp"

namespace fieldcast::config {

class FaultList {
 public:
  // Ignores a duplicate: a template is read once for each device that uses it.
  void add(const Position& position, std::string what, std::string allowed = {},
           std::string suggestion = {});

  [[nodiscard]] bool empty() const { return entries_.empty(); }
  [[nodiscard]] std::size_t size() const { return entries_.size(); }
  [[nodiscard]] bool full() const;

  // Sorted by file (the main one first), line and column; clears the list.
  [[nodiscard]] std::vector<Fault> take();

 private:
  struct Entry {
    std::size_t order;
    Fault fault;
  };
  std::vector<Entry> entries_;
  std::set<std::tuple<std::size_t, std::uint32_t, std::uint32_t, std::string>> known_;
};

}  // namespace fieldcast::config
