#include "common/eval/known_sequence.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <regex>

namespace eg::eval {
namespace {

// A noisy or shortened copy of a sequence (..._clip, ...traj0n) is not the sequence: patterns end where names end.
#define EG_LIVING(n) "(living|(^|[^a-z])lr).*(kt|traj|room)[-_ ]?" n "(_frei_png)?$"
#define EG_OFFICE(n) "(office|(^|[^a-z])of).*(kt|traj|room)[-_ ]?" n "(_frei_png)?$"
#define EG_TUM(camera, name) "f(r|reiburg)?" camera "[-_]" name "$"

constexpr std::array kSequences = {
    KnownSequence{"office room 0", "icl", EG_OFFICE("0")},
    KnownSequence{"office room 1", "icl", EG_OFFICE("1")},
    KnownSequence{"office room 2", "icl", EG_OFFICE("2")},
    KnownSequence{"office room 3", "icl", EG_OFFICE("3")},
    KnownSequence{"living room 0", "icl", EG_LIVING("0")},
    KnownSequence{"living room 1", "icl", EG_LIVING("1")},
    KnownSequence{"living room 2", "icl", EG_LIVING("2")},
    KnownSequence{"living room 3", "icl", EG_LIVING("3")},
    KnownSequence{"f1_360", "tum_fr1", EG_TUM("1", "360")},
    KnownSequence{"f1_room", "tum_fr1", EG_TUM("1", "room")},
    KnownSequence{"f1_desk", "tum_fr1", EG_TUM("1", "desk")},
    KnownSequence{"f2_rpy", "tum_fr2", EG_TUM("2", "rpy")},
    KnownSequence{"f2_xyz", "tum_fr2", EG_TUM("2", "xyz")},
    KnownSequence{"f3_l_o_house", "tum_fr3", EG_TUM("3", "(long_office_household|office)")},
    KnownSequence{"f3_stru_notex", "tum_fr3", EG_TUM("3", "structure_notexture(_near|_far)?")},
    KnownSequence{"f3_stru_tex", "tum_fr3", EG_TUM("3", "structure_texture(_near|_far)?")},
    KnownSequence{"f3_l_cabinet", "tum_fr3", EG_TUM("3", "large_cabinet")},
    KnownSequence{"f3_cabinet", "tum_fr3", EG_TUM("3", "cabinet")},
    KnownSequence{"office0", "icl", "(^|/)office0$", true},
    KnownSequence{"livingroom2", "icl", "(^|/)livingroom2$", true},
    KnownSequence{"corridor1", "tum_fr3", "(^|/)corridor1$", true},
};

#undef EG_LIVING
#undef EG_OFFICE
#undef EG_TUM

/// "/a/B/C/" → "b/c".
std::string last_two_parts(std::string_view path) {
  while (path.ends_with('/')) path.remove_suffix(1);
  const std::size_t last = path.rfind('/');
  const std::size_t before = last == 0 || last == std::string_view::npos ? last : path.rfind('/', last - 1);
  std::string parts(before == std::string_view::npos ? path : path.substr(before + 1));
  std::transform(parts.begin(), parts.end(), parts.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return parts;
}

}  // namespace

std::span<const KnownSequence> known_sequences() { return kSequences; }

const KnownSequence* find_sequence(std::string_view path, bool observations) {
  const std::string parts = last_two_parts(path);
  const auto found = std::find_if(kSequences.begin(), kSequences.end(), [&](const KnownSequence& sequence) {
    return sequence.observations == observations && std::regex_search(parts, std::regex(sequence.pattern));
  });
  return found == kSequences.end() ? nullptr : &*found;
}

}  // namespace eg::eval
