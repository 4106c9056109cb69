#pragma once

namespace eg::procman {

/// Puts the folder of this program first on PATH, so that the commands it runs find the programs beside it.
void put_own_folder_on_path();

}  // namespace eg::procman
