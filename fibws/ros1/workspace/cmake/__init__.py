"""CMake's language, as far as the CMakeLists.txt of packages use it.

syntax      a file's commands and their arguments, as they are written
condition   whether what stands in an if() is met
script      goes through the commands as CMake would, and yields those that are carried out
vocabulary  the commands and variables that there are besides
"""
