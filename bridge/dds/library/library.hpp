// Settings of Fast DDS for the whole process, made before the first participant is created.
#pragma once

#include <functional>
#include <stdexcept>
#include <string_view>

#include "core/base/time.hpp"

namespace fieldcast {

// May be called from any thread, any number of times.
// - Participants of one process use their transports. The library's shortcut inside a process skips
//   the reliable protocol and loses messages that are written before both ends have matched.
// - The library's messages go to standard error, one plain line each. By default they are coloured
//   and go to standard output, between our JSON lines.
void prepare_library();

// Redirects the library's messages: a daemon must not wait for the reader of its standard error.
// `lines` is called on any of its threads. `kind`: the component that logs.
using LibraryLines = void (*)(bool error, std::string_view kind, std::string_view text);
void set_library_lines(LibraryLines lines);

// Our messages about DDS Security use the same function, with this kind.
inline constexpr std::string_view kSecurityLine = "security";
void say_security(bool error, std::string_view text);

// A silent participant is removed by the others after this time.
inline constexpr Duration kParticipantLease = std::chrono::seconds{10};

// Sets the handler of a process whose member was paused beyond its lease; empty: none. The other
// members have removed it, but it has not removed them, and Fast DDS 2.9 begins no second handshake
// with a member that it knows. It must join again. The handler runs on any thread, and no longer
// after this returns.
void on_removed(std::function<void()> handler);
void report_removed();

// DDS cannot be started, or an entity cannot be created. The only exception of the DDS folders.
class DdsError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace fieldcast
