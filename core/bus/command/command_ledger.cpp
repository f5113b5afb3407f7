#include "core/bus/command/command_ledger.hpp"

#include <functional>

namespace fieldcast {

std::size_t CommandLedger::Hash::operator()(const Key* key) const {
  return std::hash<std::string>{}(key->first) ^ key->second * 0x9E3779B97F4A7C15u;
}

bool CommandLedger::enter(std::string_view requester, std::uint64_t request_id) {
  const Key key{requester, request_id};
  if (known_.contains(&key)) return false;
  if (order_.size() == remembered_) {
    known_.erase(&order_.front());
    order_.pop_front();
  }
  known_.insert(&order_.emplace_back(key));
  return true;
}

}  // namespace fieldcast
