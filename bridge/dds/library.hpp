// Settings of Fast DDS that hold for the whole process, made before the first participant.
#pragma once

#include <string_view>

namespace fieldcast {

// Any thread, any number of times.
//  - Participants of one process use their transports like all others. The library's short cut
//    inside a process skips the reliable protocol, and loses what is written before both ends have
//    matched.
//  - The library's messages go to standard error, one plain line each. By default they are coloured
//    and go to standard output, among our JSON lines.
void prepare_library();

// Where the library's messages go instead, from any of its threads: a daemon must not wait for the
// reader of its standard error. `kind` is the library's name for its part that gives the message.
using LibraryLines = void (*)(bool error, std::string_view kind, std::string_view text);
void set_library_lines(LibraryLines lines);

// What we have to say about DDS Security goes the same way, with this kind.
inline constexpr std::string_view kSecurityLine = "security";
void say_security(bool error, std::string_view text);

}  // namespace fieldcast
