#pragma once

#include <string>

/// Numbers in files: the same bytes for the same value, whatever the locale.
namespace eg::io {

/// The shortest decimal text that reads back as exactly this value, e.g. 0.1.
std::string format_number(double value);

/// At most `digits` significant digits, without trailing zeros, e.g. 3.14159 for digits = 6; -0 is 0.
std::string format_significant(double value, int digits);

/// Exactly `decimals` digits after the point, e.g. 1341836537.655662 for decimals = 6; -0 is 0.
std::string format_fixed(double value, int decimals);

}  // namespace eg::io
