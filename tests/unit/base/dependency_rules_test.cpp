#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

/// Who may include whom: docs/architecture.md. The rules are read from the sources as they are.
namespace eg {
namespace {

namespace fs = std::filesystem;
using Graph = std::map<std::string, std::set<std::string>>;

const fs::path kRoot = EGRAPH_SOURCE_DIR;

struct Include {
  fs::path file;  ///< relative to the root
  int line = 0;
  std::string target;

  [[nodiscard]] std::string where() const { return file.string() + ":" + std::to_string(line) + " includes " + target; }
  /// The n-th part of the including file's path, "" if there is none.
  [[nodiscard]] std::string part(int n) const {
    for (const fs::path& part : file) {
      if (n-- == 0) return part.string();
    }
    return "";
  }
};

std::string read(const fs::path& path) {
  std::ifstream stream(path);
  std::stringstream text;
  text << stream.rdbuf();
  return text.str();
}

std::vector<Include> includes_under(const std::string& folder) {
  static const std::regex pattern(R"re(^\s*#\s*include\s*["<]([^">]+)[">])re");
  std::vector<Include> includes;
  for (const auto& entry : fs::recursive_directory_iterator(kRoot / folder)) {
    const std::string extension = entry.path().extension().string();
    if (extension != ".cpp" && extension != ".hpp" && extension != ".h" && extension != ".c") continue;
    std::ifstream stream(entry.path());
    std::smatch match;
    std::string line;
    for (int number = 1; std::getline(stream, line); ++number) {
      if (!std::regex_search(line, match, pattern)) continue;
      includes.push_back({fs::relative(entry.path(), kRoot), number, match[1]});
    }
  }
  return includes;
}

/// The second part of "common/geometry/pose.hpp".
std::string library_of(const std::string& target) {
  const std::size_t begin = std::string("common/").size();
  return target.substr(begin, target.find('/', begin) - begin);
}

/// What every library of common/CMakeLists.txt links to, directly.
Graph linked_libraries() {
  const std::string text = read(kRoot / "common/CMakeLists.txt");
  static const std::regex declaration(R"(egraph_library\((\w+)([^)]*)\))");
  static const std::regex dependency(R"(\beg_(\w+))");
  Graph graph;
  for (std::sregex_iterator it(text.begin(), text.end(), declaration), end; it != end; ++it) {
    const std::string arguments = (*it)[2];
    std::set<std::string>& links = graph[(*it)[1]];
    for (std::sregex_iterator link(arguments.begin(), arguments.end(), dependency); link != end; ++link) {
      links.insert((*link)[1]);
    }
  }
  graph.erase("name");  // the function's own definition
  return graph;
}

/// Everything that can be reached from `library`, itself left out unless it lies on a cycle.
std::set<std::string> reachable(const Graph& graph, const std::string& library) {
  std::set<std::string> seen;
  std::vector<std::string> open = {library};
  while (!open.empty()) {
    const auto links = graph.find(open.back());
    open.pop_back();
    if (links == graph.end()) continue;
    for (const std::string& next : links->second) {
      if (seen.insert(next).second) open.push_back(next);
    }
  }
  return seen;
}

class DependencyRules : public testing::Test {
 protected:
  void forbid(const std::vector<Include>& includes, const auto& is_wrong, const std::string& rule) {
    for (const Include& include : includes) {
      if (is_wrong(include)) ADD_FAILURE() << include.where() << ": " << rule;
    }
  }

  std::vector<Include> common_ = includes_under("common");
  std::vector<Include> services_ = includes_under("services");
  Graph graph_ = linked_libraries();
};

TEST_F(DependencyRules, TheSourcesAreThere) {
  EXPECT_GT(common_.size(), 100U);
  EXPECT_GT(services_.size(), 10U);
  EXPECT_GE(graph_.size(), 14U);
}

TEST_F(DependencyRules, EveryFolderOfCommonIsADeclaredLibrary) {
  for (const auto& entry : fs::directory_iterator(kRoot / "common")) {
    if (!entry.is_directory()) continue;
    EXPECT_TRUE(graph_.contains(entry.path().filename().string())) << entry.path();
  }
}

TEST_F(DependencyRules, LibrariesDoNotDependOnEachOtherInCircles) {
  for (const auto& [library, links] : graph_) EXPECT_FALSE(reachable(graph_, library).contains(library)) << library;
}

TEST_F(DependencyRules, LibrariesLieInLayers) {
  // base → geometry → image → {codec, features, synthetic} → egraph → tracking; mapping and eval sit on geometry and
  // image. A lower library never reaches a higher one.
  using Names = std::set<std::string>;
  const Names image = {"base", "geometry", "image"};
  const Graph allowed = {{"base", {}},
                         {"geometry", {"base"}},
                         {"image", {"base", "geometry"}},
                         {"codec", image},
                         {"features", image},
                         {"synthetic", image},
                         {"egraph", {"base", "geometry", "image", "features"}},
                         {"tracking", {"base", "geometry", "image", "features", "egraph"}},
                         {"mapping", image},
                         {"eval", image},
                         {"observations", {"base", "geometry", "image", "features", "synthetic"}},
                         {"procman", {"base"}},
                         {"transport", {"base"}}};
  for (const auto& [library, below] : allowed) {
    for (const std::string& reached : reachable(graph_, library)) {
      EXPECT_TRUE(below.contains(reached)) << library << " depends on " << reached;
    }
  }
}

TEST_F(DependencyRules, LibrariesIncludeOnlyWhatTheyLinkTo) {
  forbid(
      common_,
      [&](const Include& include) {
        if (!include.target.starts_with("common/")) return false;
        const std::string from = include.part(1);
        const std::string to = library_of(include.target);
        return from != to && !reachable(graph_, from).contains(to);
      },
      "common/CMakeLists.txt does not link these libraries");
}

TEST_F(DependencyRules, CommonKnowsNoServicesAndNobodyKnowsTheTests) {
  forbid(
      common_, [](const Include& i) { return i.target.starts_with("services/"); }, "libraries know no services");
  const auto of_tests = [](const Include& i) {
    return i.target.starts_with("tests/") || i.target.starts_with("gtest/");
  };
  forbid(common_, of_tests, "nothing depends on tests");
  forbid(services_, of_tests, "nothing depends on tests");
}

TEST_F(DependencyRules, AServiceIncludesNoOtherService) {
  forbid(
      services_,
      [](const Include& include) {
        const std::string own = "services/" + include.part(1) + "/";
        return include.target.starts_with("services/") && !include.target.starts_with(own);
      },
      "services talk by messages only");
}

TEST_F(DependencyRules, IncludesStartAtTheRoot) {
  const auto relative = [](const Include& i) { return i.target.starts_with("./") || i.target.starts_with("../"); };
  forbid(common_, relative, "paths start at the root of the project");
  forbid(services_, relative, "paths start at the root of the project");
}

TEST_F(DependencyRules, LcmIsIncludedByTransportOnly) {
  const auto of_lcm = [](const Include& i) { return i.target.starts_with("lcm/"); };
  forbid(services_, of_lcm, "only common/transport talks to LCM");
  forbid(
      common_, [&](const Include& i) { return of_lcm(i) && i.part(1) != "transport"; },
      "only common/transport talks to LCM");
}

TEST_F(DependencyRules, GeneratedTypesAreIncludedByMessagesAndServicesOnly) {
  forbid(
      common_, [](const Include& i) { return i.target.starts_with("egraph_msgs/") && i.part(1) != "messages"; },
      "only common/messages and services know the generated types");
}

TEST_F(DependencyRules, OpenVdbIsSeenByMappingsSourceFilesOnly) {
  // A header of mapping's own may use OpenVDB, if it reaches nobody else: then no other library is compiled with it.
  std::set<std::string> carriers;
  const auto brings_openvdb = [&](const Include& i) {
    return i.target.starts_with("openvdb/") || carriers.contains(i.target);
  };
  for (std::size_t known = 0; known == 0 || known < carriers.size();) {
    known = std::max<std::size_t>(carriers.size(), 1);
    for (const Include& i : common_) {
      if (i.file.extension() == ".hpp" && brings_openvdb(i)) carriers.insert(i.file.string());
    }
  }
  forbid(services_, brings_openvdb, "only common/mapping knows OpenVDB");
  forbid(
      common_, [&](const Include& i) { return brings_openvdb(i) && i.part(1) != "mapping"; },
      "only common/mapping knows OpenVDB");
}

TEST_F(DependencyRules, AlgorithmsHaveNoClockNoGlobalRandomnessAndNoEnvironment) {
  const std::set<std::string> algorithms = {"base",   "geometry", "image",   "codec", "features",    "synthetic",
                                            "egraph", "tracking", "mapping", "eval",  "observations"};
  const std::set<std::string> forbidden = {"chrono", "ctime", "time.h", "random", "iostream", "fstream", "filesystem"};
  forbid(
      common_, [&](const Include& i) { return algorithms.contains(i.part(1)) && forbidden.contains(i.target); },
      "time, seed, options and files are arguments");
}

}  // namespace
}  // namespace eg
