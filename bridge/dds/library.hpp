// Settings of Fast DDS that hold for the whole process, made before the first participant.
#pragma once

#include <string_view>

namespace fieldcast {

// Any thread, any number of times.
//  - Participants of one process talk through their transports like all others: the library's short
//  cut inside a process skips the
//    reliable protocol and loses what is written before both ends have matched.
//  - The library's messages go to standard error as one plain line each, instead of coloured ones
//  to standard output, where they would
//    stand between our JSON lines.
void prepare_library();

// Where the library's messages go instead, from any of its threads: a daemon must not wait for who
// reads its standard error. `kind` is the library's word for the part of it that speaks.
using LibraryLines = void (*)(bool error, std::string_view kind, std::string_view text);
void set_library_lines(LibraryLines lines);

}  // namespace fieldcast
