"""Contact laws, one file each, over `contact.Touching`."""
